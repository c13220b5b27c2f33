#pragma once

#include <Eigen/Geometry>
#include <optional>
#include <string>

#include "graspd/agent/ports.hpp"
#include "graspd/record/json_lines.hpp"
#include "graspd/types/request.hpp"

namespace graspd::record {

/// The frames that an arm's poses are to be read in.
struct CellFrames {
  std::string cell;
  Eigen::Isometry3d T_base_camera = Eigen::Isometry3d::Identity();
  std::optional<Bin> bin;
};

/// An arm with a gripper that does nothing but write down what it is told: every pose is within its
/// reach, every grasp holds. The file's first line says the cell's frames, then each line one
/// order.
class RecordingArm final : public agent::Arm, public agent::Gripper {
 public:
  /// \returns INVALID_ARGUMENT where the file can't be made.
  static Result<RecordingArm> create(const std::filesystem::path& path, const CellFrames& frames);

  void set_surroundings(const agent::Surroundings&) override {}
  std::optional<std::string> why_not(std::span<const agent::Motion> motions) override;
  Result<void> move(const agent::Motion& motion) override;
  Result<void> move_out_of_view() override;
  Result<void> stop() override;

  Result<void> open(double opening_width_m) override;
  Result<void> close() override;
  Result<bool> holds_something() override;

 private:
  explicit RecordingArm(JsonLines lines) : lines_(std::move(lines)) {}

  JsonLines lines_;
  std::uint64_t pick_n_ = 0;  ///< picks begun so far
  bool closed_ = false;
  agent::Step last_step_ = agent::Step::kOutOfView;  ///< that it moved for
};

}  // namespace graspd::record
