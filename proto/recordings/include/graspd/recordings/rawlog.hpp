#pragma once

#include <Eigen/Geometry>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>

#include "graspd/types/frame.hpp"

/// Recordings of depth frames as MRPT rawlogs (gzip streams of CObservation3DRangeScan), which
/// RawLogViewer opens. Intrinsics, distortion and depth scale travel with every frame. What was
/// asked with it (camera pose, bin, parts, gripper) and answered stand in front of it as comments,
/// in the JSON of graspd.v1.
namespace graspd {

/// One observation, and what was asked and answered with it.
struct RecordedFrame {
  DepthFrame frame;
  double stamp_s = 0;  ///< since 1970
  // Without {}, compilers warn of initialisers that leave out what was not recorded.
  // NOLINTBEGIN(readability-redundant-member-init)
  std::optional<Eigen::Isometry3d> T_base_camera{};  ///< for viewers; the request has it to the bit
  std::string request{};                             ///< a PlanRequest as JSON; empty: not recorded
  std::string answer{};                              ///< a PlanAnswer as JSON; empty: not recorded
  // NOLINTEND(readability-redundant-member-init)
};

/// Writes one rawlog. Belongs to one thread.
class RawlogWriter {
 public:
  /// \returns INVALID_ARGUMENT where the file can't be made.
  static Result<RawlogWriter> create(const std::filesystem::path& path);

  RawlogWriter(RawlogWriter&&) noexcept;
  RawlogWriter& operator=(RawlogWriter&&) noexcept;
  ~RawlogWriter();

  /// The file's order is the order of calls. What was added can be read, whatever becomes of this
  /// process.
  /// \returns INVALID_ARGUMENT for a frame that is none, INTERNAL where the disk takes no more.
  Result<void> add(const RecordedFrame& recorded);
  Result<void> add(const DepthFrame& frame, double stamp_s) { return add({frame, stamp_s}); }
  /// Ends the file. The destructor does so too, but can't say that it failed.
  Result<void> finish();

 private:
  struct Impl;
  explicit RawlogWriter(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

/// Reads the depth frames of any rawlog, also those inside sensory frames; other observations are
/// passed over. Holds one frame at a time, however large the file. One reader belongs to one
/// thread.
class RawlogReader {
 public:
  /// \returns INVALID_ARGUMENT where there is no such file.
  static Result<RawlogReader> open(const std::filesystem::path& path);

  RawlogReader(RawlogReader&&) noexcept;
  RawlogReader& operator=(RawlogReader&&) noexcept;
  ~RawlogReader();

  /// The next frame, or nothing after the last one. A file that is cut short or damaged gives all
  /// frames before the damage and then
  /// \returns INVALID_ARGUMENT saying after how many frames and at which byte it broke.
  Result<std::optional<RecordedFrame>> next();

 private:
  struct Impl;
  explicit RawlogReader(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace graspd
