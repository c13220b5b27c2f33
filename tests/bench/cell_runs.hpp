#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "cell_config.hpp"
#include "graspd/agent/ports.hpp"
#include "graspd/parts/catalogue.hpp"
#include "graspd/simulated/sim_cell.hpp"
#include "graspd/simulation/pile.hpp"

/// What `./run bench cell` does with one bin.
namespace graspd::bench {

/// A way from frame to grasps.
struct Pipeline {
  std::string name;
  PlanOptions plan;
};

/// The paper's four, its own method, ours; and both of the latter by the paper's other reading of
/// the order.
std::vector<Pipeline> all_pipelines();

struct BinKey {
  std::string pipeline, part;
  int seed = 0;
  bool operator==(const BinKey&) const = default;
};

struct PickRow {
  int pick_n = 0;  ///< counted from 1
  std::string verdict, why;
  double others_moved_m = 0;
  double planning_s = 0;
  double cpu_s = 0;   ///< that the simulation took
  double score = 0;   ///< of the object: how probable its pose was
  double room_m = 0;  ///< of the grasp
};

struct BinRow {
  std::string commit;  ///< of the sources that it was emptied by, as far as it is known
  int parts_n = 0, placed_n = 0;
  double duration_s = 0;  ///< simulated motion and measured planning
  double planning_s = 0;
  double wall_s = 0;
  /// How often the arm was set going again after it had met resistance; not known of older rows.
  std::optional<int> resets_n;
  std::string reason;  ///< why the agent ended
};

/// What moves the gripper.
using Carrier = std::variant<motion::MountedArm, agent::FloatingOptions>;

struct BinJob {
  const parts::Part& part;
  Pipeline pipeline;
  robot_agent::CellConfig cell;  ///< with the pile's number and seed
  Carrier carrier;
  std::optional<std::filesystem::path> gif;  ///< where an animation goes, if one is wanted
};

/// Has the agent empty a bin. \param on_pick called after each pick's verdict.
Result<BinRow> empty_bin(const BinJob& job, const simulation::PileMaker& piles,
                         agent::Planner& planner,
                         const std::function<void(const PickRow&)>& on_pick);

}  // namespace graspd::bench
