#pragma once

#include <fstream>
#include <functional>
#include <memory>
#include <nlohmann/json.hpp>

#include "graspd/record/recording_arm.hpp"
#include "graspd/simulated/sim_cell.hpp"
#include "motion_cell.hpp"
#include "named.hpp"
#include "scripted_cell.hpp"
#include "temporary_folder.hpp"

/// The arms that `arm_contract_test` runs on. Another one is a class that makes it, and its line in
/// `kArmRigs`.
namespace graspd::testing {

/// An arm at its place out of view, before a bin.
class ArmRig {
 public:
  virtual ~ArmRig() = default;
  virtual agent::Arm& arm() = 0;
  /// Where the gripper truly is; nothing where it is not known.
  virtual std::optional<Eigen::Isometry3d> T_base_grasp() = 0;
  /// What time its motions take passes on; none where they take none.
  virtual agent::Clock* clock() = 0;
  /// A pose that this arm does not reach; none where it reaches every one.
  virtual std::optional<Eigen::Isometry3d> T_base_unreachable() { return std::nullopt; }
};

class SimulatedArmRig : public ArmRig {
 public:
  using Carrier = std::variant<motion::MountedArm, agent::FloatingOptions>;
  explicit SimulatedArmRig(const Carrier& carrier)
      : cell_(agent::SimCell::create(kinds_, {}, options(), carrier).value()) {}

  agent::Arm& arm() override { return cell_->arm(); }
  std::optional<Eigen::Isometry3d> T_base_grasp() override {
    return cell_->physics().T_base_grasp();
  }
  agent::Clock* clock() override { return &cell_->clock(); }

 private:
  static sim_cell::PhysicsCellOptions options() {
    sim_cell::PhysicsCellOptions options = scripted_options();
    options.bin = MotionCell::bin();
    options.place.T_base_bin.translation().x() = 1;
    return options;
  }

  const std::vector<parts::Mesh> kinds_;
  const std::unique_ptr<agent::SimCell> cell_;
};

class PlannedArmRig final : public SimulatedArmRig {
 public:
  PlannedArmRig() : SimulatedArmRig(mounted()) {}
  std::optional<Eigen::Isometry3d> T_base_unreachable() override {
    return MotionCell::down(0.9, 0, 0.2);
  }

 private:
  static motion::MountedArm mounted() {
    const MotionCell cell;
    return {cell.arm, cell.parameters, cell.out_of_view_rad};
  }
};

class FloatingArmRig final : public SimulatedArmRig {
 public:
  FloatingArmRig()
      : SimulatedArmRig(
            agent::FloatingOptions{.T_base_out_of_view = MotionCell::down(0, 0.3, 0.3)}) {}
};

class RecordingArmRig final : public ArmRig {
 public:
  agent::Arm& arm() override { return arm_; }
  /// As the last line says.
  std::optional<Eigen::Isometry3d> T_base_grasp() override {
    std::ifstream file(path_);
    nlohmann::json last;
    for (std::string line; std::getline(file, line);) {
      const auto order = nlohmann::json::parse(line);
      if (order.value("step", "") != "stop") last = order;
    }
    if (!last.contains("T_base_grasp")) return std::nullopt;
    const auto numbers = last.at("T_base_grasp").get<std::array<double, 16>>();
    Eigen::Isometry3d T;
    T.matrix() = Eigen::Map<const Eigen::Matrix<double, 4, 4, Eigen::RowMajor>>(numbers.data());
    return T;
  }
  agent::Clock* clock() override { return nullptr; }

 private:
  TemporaryFolder folder_;
  const std::filesystem::path path_ = folder_.path() / "arm.jsonl";
  record::RecordingArm arm_ = record::RecordingArm::create(path_, {}).value();
};

using NamedArmRig = Named<std::function<std::unique_ptr<ArmRig>()>>;

inline const NamedArmRig kArmRigs[] = {
    {"planned", make_rig<PlannedArmRig>},
    {"floating", make_rig<FloatingArmRig>},
    {"record", make_rig<RecordingArmRig>},
};

}  // namespace graspd::testing
