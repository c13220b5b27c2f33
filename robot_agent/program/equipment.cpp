#include "equipment.hpp"

#include "driven_arm.hpp"
#include "graspd/agent/averaging_camera.hpp"
#include "graspd/record/recording_arm.hpp"
#include "graspd/replay/replay_camera.hpp"
#include "simulated_equipment.hpp"
#include "system_clock.hpp"

namespace graspd::robot_agent {
namespace {

using MadeCamera = Result<std::unique_ptr<agent::Camera>>;

MadeCamera make_replay(const CameraConfig& config, const CellFrames& frames, agent::Clock& clock) {
  replay::ReplayOptions options;
  options.loop = config.loop;
  if (config.frames_n > 0) options.max_frames_n = config.frames_n;
  options.period = std::chrono::nanoseconds(static_cast<std::int64_t>(config.period_s * 1e9));
  options.intrinsics = frames.intrinsics;
  const auto kind = config.kind == CameraKind::kBop ? replay::RecordingKind::kBop
                                                    : replay::RecordingKind::kRawlog;
  return replay::open_recording(kind, config.path, options, clock);
}

/// \param frames with intrinsics: such a camera is calibrated.
MadeCamera make_device(openni2::CameraOptions options, const CellFrames& frames,
                       agent::Clock& clock) {
  options.camera = *frames.intrinsics;
  options.depth_correction = frames.depth_correction;
  return openni2::open_camera(options, clock);
}

Result<void> add_camera(const CameraConfig& config, const CellFrames& frames,
                        Equipment& equipment) {
  auto camera = config.is_recording() ? make_replay(config, frames, *equipment.clock)
                                      : make_device(config.device, frames, *equipment.clock);
  if (!camera) return tl::unexpected(camera.error());
  equipment.camera = *std::move(camera);
  return {};
}

Result<void> add_recording_arm(const CellConfig& config, const CellFrames& frames,
                               Equipment& equipment) {
  auto arm = record::RecordingArm::create(config.arm.record,
                                          {config.cell, frames.T_base_camera, frames.bin});
  if (!arm) return tl::unexpected(arm.error());
  const auto robot = std::make_shared<record::RecordingArm>(*std::move(arm));
  equipment.arm = robot;
  equipment.gripper = robot;
  return {};
}

Result<void> add_arm(const CellConfig& config, const CellFrames& frames, Equipment& equipment) {
  if (config.arm.kind == ArmKind::kRecord) return add_recording_arm(config, frames, equipment);
  auto arm = make_driven_arm(config);
  if (!arm) return tl::unexpected(arm.error());
  equipment.arm = *std::move(arm);
  return {};
}

/// In the place of the arm's own, if it has one.
Result<void> add_gripper(const std::optional<output_gripper::GripperOptions>& output,
                         Equipment& equipment) {
  if (!output) return {};
  auto gripper = output_gripper::make_gripper(*output, *equipment.clock);
  if (!gripper) return tl::unexpected(gripper.error());
  equipment.gripper = *std::move(gripper);
  return {};
}

}  // namespace

Result<Equipment> make_equipment(const CellConfig& config, const CellFrames& frames) {
  auto equipment = make_camera(config, frames);
  if (!equipment) return equipment;
  if (config.averaged_frames_n > 1) {
    equipment->camera =
        std::make_shared<agent::AveragingCamera>(equipment->camera, config.averaged_frames_n);
  }
  if (config.arm.pile) return equipment;
  const auto made = add_arm(config, frames, *equipment).and_then([&] {
    return add_gripper(config.gripper_output, *equipment);
  });
  if (!made) return tl::unexpected(made.error());
  return equipment;
}

Result<Equipment> make_camera(const CellConfig& config, const CellFrames& frames) {
  if (config.arm.pile) return make_simulated_equipment(config);  // one thing is all of it
  Equipment equipment;
  equipment.clock = std::make_shared<SystemClock>();
  if (auto ok = add_camera(*config.camera, frames, equipment); !ok) {
    return tl::unexpected(ok.error());
  }
  return equipment;
}

}  // namespace graspd::robot_agent
