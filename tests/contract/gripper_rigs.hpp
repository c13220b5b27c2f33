#pragma once

#include <functional>
#include <memory>

#include "fake_clock.hpp"
#include "graspd/output_gripper/output_gripper.hpp"
#include "graspd/record/recording_arm.hpp"
#include "graspd/simulated/sim_cell.hpp"
#include "named.hpp"
#include "scripted_cell.hpp"
#include "temporary_folder.hpp"

/// The grippers that `gripper_contract_test` runs on. Another one is a class that makes it, and its
/// line in `kGripperRigs`.
namespace graspd::testing {

/// A gripper that has a part between its fingers when it closes.
class GripperRig {
 public:
  virtual ~GripperRig() = default;
  virtual agent::Gripper& gripper() = 0;
};

class OutputRig final : public GripperRig {
 public:
  agent::Gripper& gripper() override { return *gripper_; }

 private:
  agent::fakes::FakeClock clock_;
  std::unique_ptr<agent::Gripper> gripper_ =
      output_gripper::make_gripper({.open = {"true"}, .close = {"true"}, .sensor = {"true"}},
                                   clock_)
          .value();
};

class RecordingRig final : public GripperRig {
 public:
  agent::Gripper& gripper() override { return arm_; }

 private:
  TemporaryFolder folder_;
  record::RecordingArm arm_ =
      record::RecordingArm::create(folder_.path() / "arm.jsonl", {}).value();
};

class SimulatedGripperRig final : public GripperRig {
 public:
  agent::Gripper& gripper() override { return cell_->gripper(); }

 private:
  static simulation::Pile one_box() {
    simulation::Pile pile;
    pile.parts.push_back({0, at(0, 0, 0.02)});
    return pile;
  }

  const std::vector<parts::Mesh> kinds_{box_mesh({0.01, 0.05, 0.04})};
  /// The jaws about the thin box, which stands in the bin.
  const std::unique_ptr<agent::SimCell> cell_ =
      agent::SimCell::create(kinds_, one_box(), scripted_options(),
                             agent::FloatingOptions{.T_base_out_of_view = down_at(0, 0, 0.01)})
          .value();
};

using NamedGripperRig = Named<std::function<std::unique_ptr<GripperRig>()>>;

inline const NamedGripperRig kGripperRigs[] = {
    {"output", make_rig<OutputRig>},
    {"record", make_rig<RecordingRig>},
    {"simulated", make_rig<SimulatedGripperRig>},
};

}  // namespace graspd::testing
