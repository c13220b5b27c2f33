#pragma once

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string_view>
#include <utility>

#include "graspd/agent/ports.hpp"

/// A recording in the place of a camera.
namespace graspd::replay {

/// A BOP scene's folder, or an MRPT rawlog.
enum class RecordingKind { kBop, kRawlog };

/// How a recording is played.
struct ReplayOptions {
  bool loop = false;                                          ///< start again at the end
  std::optional<std::uint64_t> max_frames_n = std::nullopt;   ///< in all
  std::chrono::nanoseconds period{0};                         ///< 0: as fast as asked for
  std::optional<CameraIntrinsics> intrinsics = std::nullopt;  ///< instead of the recorded ones
};

/// Frames in the order they were recorded in, a BOP scene's by image number. All have one size: a
/// recording is of one camera.
///
/// What can be read of a damaged recording is given out; then `next` is an INVALID_ARGUMENT that
/// says in which file and after how many frames it broke, and so is every call after it.
///
/// \param path a rawlog file, or the folder of a BOP scene.
/// \returns INVALID_ARGUMENT where there is no such recording.
Result<std::unique_ptr<agent::Camera>> open_recording(RecordingKind kind,
                                                      const std::filesystem::path& path,
                                                      const ReplayOptions& options,
                                                      agent::Clock& clock);

}  // namespace graspd::replay

template <>
struct graspd::EnumNames<graspd::replay::RecordingKind> {
  using Kind = replay::RecordingKind;
  static constexpr std::string_view what = "kind of recording";
  static constexpr std::pair<Kind, std::string_view> values[] = {{Kind::kBop, "bop"},
                                                                 {Kind::kRawlog, "rawlog"}};
};
