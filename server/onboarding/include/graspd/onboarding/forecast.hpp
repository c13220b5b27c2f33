#pragma once

#include <array>
#include <functional>
#include <optional>
#include <vector>

#include "graspd/eval/pose_accuracy.hpp"
#include "graspd/perception/parameters.hpp"
#include "graspd/simulation/scene.hpp"
#include "graspd/types/answer.hpp"
#include "graspd/types/request.hpp"

/// What a cell may expect of a part: simulated piles of it, as the cell's camera would see them, go
/// through the planner, and the answers are compared with the true poses.
namespace graspd::onboarding {

/// The cell that the forecast is of.
struct ForecastOptions {
  simulation::SceneOptions
      scene;  ///< bin, camera and seed of the first pile; its parts are set here
  Gripper gripper;
  perception::Parameters parameters;
  int piles_n = 24;
  int parts_n = 0;       ///< in each pile; 0: as many as `parts_that_fit`
  double limit_s = 120;  ///< no pile is begun after that; the figures are of those before
};

/// One pile, first frame.
struct PileForecast {
  int parts_n = 0;
  Outcome outcome = Outcome::kPlanned;
  eval::PoseAccuracy poses;
  int pickable_n =
      0;  ///< of the objects visible by half or more: found, with a grasp free of collisions
  bool is_first_right = false;     ///< the best grasp is of a part in its true pose
  std::vector<double> openings_m;  ///< of the jaws, one for each object: its best grasp's
  std::array<std::uint32_t, std::size(EnumNames<Check>::values)> rejected_by_check_n{};
  double plan_s = 0;
};

/// One plan, to be drawn.
struct PlannedFrame {
  DepthFrame frame;
  PlanRequest request;
  PlanAnswer answer;
};

/// All piles. The sums below are over them.
struct Forecast {
  std::vector<PileForecast> piles;
  int asked_n = 0;       ///< piles; fewer were made where the time was up
  PlannedFrame picture;  ///< of the first pile, with outlines
  double duration_s = 0;

  eval::PoseAccuracy poses() const;
  int pickable_n() const;
  int first_right_n() const;
  std::vector<double> openings_m() const;
};

/// A bin that is full to about half its volume, and no more than a camera can see of: 4 to 60.
int parts_that_fit(const parts::Part& part, const Eigen::Vector3d& bin_inner_size_m);

/// Piles are made on all cores; plans are timed after that, one by one. But for the times, the same
/// options give the same figures, unless the time limit ends one run earlier than the other.
/// \param part with a number, `bop_obj_id`. \param progress called with a step's name, and how many
/// of how many are done.
Result<Forecast> forecast(
    const parts::Part& part, const ForecastOptions& options,
    const std::function<void(std::string_view step, int done_n, int of_n)>& progress = {});

}  // namespace graspd::onboarding
