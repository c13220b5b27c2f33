#include "graspd/replay/replay_camera.hpp"

#include <algorithm>

#include "recording.hpp"

namespace graspd::replay {
namespace {

Result<std::unique_ptr<agent::Camera>> open(RecordingKind kind, const std::filesystem::path& path) {
  return kind == RecordingKind::kBop ? open_bop_scene(path) : open_rawlog(path);
}

std::string size_of(const CameraIntrinsics& camera) {
  return fmt::format("{} × {}", camera.width_px, camera.height_px);
}

/// One recording, passed through once or again and again.
class ReplayCamera final : public agent::Camera {
 public:
  ReplayCamera(RecordingKind kind, std::filesystem::path path,
               std::unique_ptr<agent::Camera> recording, const ReplayOptions& options,
               agent::Clock& clock)
      : kind_(kind),
        path_(std::move(path)),
        recording_(std::move(recording)),
        options_(options),
        clock_(clock) {}

  Result<std::optional<DepthFrame>> next() override {
    if (broken_) return tl::unexpected(*broken_);
    if (options_.max_frames_n && given_n_ >= *options_.max_frames_n) return std::nullopt;
    auto frame = next_recorded();
    if (frame && *frame) frame = as_one_camera(*std::move(*frame));
    if (!frame) {
      broken_ = frame.error();
      return frame;
    }
    if (!*frame) return frame;
    wait_until_due();
    ++given_n_;
    return frame;
  }

 private:
  Result<std::optional<DepthFrame>> next_recorded() {
    auto frame = recording_->next();
    const bool is_over = frame && !*frame;
    if (!is_over || !options_.loop || given_n_ == 0) return frame;
    auto again = open(kind_, path_);
    if (!again) return tl::unexpected(again.error());
    recording_ = *std::move(again);
    return recording_->next();
  }

  Result<std::optional<DepthFrame>> as_one_camera(DepthFrame frame) {
    if (options_.intrinsics) {
      const CameraIntrinsics& calibrated = *options_.intrinsics;
      if (size_of(calibrated) != size_of(frame.camera)) {
        return invalid("{}: frame {} has {} pixels, but the camera's calibration is for {}",
                       path_.string(), given_n_, size_of(frame.camera), size_of(calibrated));
      }
      frame.camera = calibrated;
    }
    if (given_n_ == 0) first_ = frame.camera;
    if (size_of(first_) != size_of(frame.camera)) {
      return invalid(
          "{}: frame {} has {} pixels, the frames before it {}; a recording is of one "
          "camera",
          path_.string(), given_n_, size_of(frame.camera), size_of(first_));
    }
    return frame;
  }

  /// A reader that is late gets its frame at once, and the next one a period after that.
  void wait_until_due() {
    const auto now = clock_.now();
    const auto due = given_n_ == 0 ? now : last_ + options_.period;
    if (due > now) clock_.sleep_for(due - now);
    last_ = std::max(due, now);
  }

  RecordingKind kind_;
  std::filesystem::path path_;
  std::unique_ptr<agent::Camera> recording_;
  ReplayOptions options_;
  agent::Clock& clock_;
  std::uint64_t given_n_ = 0;
  CameraIntrinsics first_;
  std::chrono::nanoseconds last_{};
  std::optional<Error> broken_;
};

}  // namespace

Result<std::unique_ptr<agent::Camera>> open_recording(RecordingKind kind,
                                                      const std::filesystem::path& path,
                                                      const ReplayOptions& options,
                                                      agent::Clock& clock) {
  auto recording = open(kind, path);
  if (!recording) return tl::unexpected(recording.error());
  return std::make_unique<ReplayCamera>(kind, path, *std::move(recording), options, clock);
}

}  // namespace graspd::replay
