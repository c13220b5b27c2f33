#pragma once

#include <filesystem>
#include <memory>
#include <optional>

#include "graspd/types/frame.hpp"

/// Recordings of depth frames as MRPT rawlogs (gzip streams of CObservation3DRangeScan), which
/// RawLogViewer opens. Intrinsics, distortion and depth scale travel with every frame.
namespace graspd {

class RawlogWriter {
 public:
  /// \returns INVALID_ARGUMENT where the file can't be made.
  static Result<RawlogWriter> create(const std::filesystem::path& path);

  RawlogWriter(RawlogWriter&&) noexcept;
  RawlogWriter& operator=(RawlogWriter&&) noexcept;
  ~RawlogWriter();

  /// `stamp_s`: seconds since 1970, the file's order is the order of calls.
  Result<void> add(const DepthFrame& frame, double stamp_s);
  /// Writes what is still in memory. The destructor does so too, but can't say that it failed.
  Result<void> finish();

 private:
  struct Impl;
  explicit RawlogWriter(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

/// Reads the depth frames of any rawlog, also those inside sensory frames; other observations are
/// passed over. One reader belongs to one thread.
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
  Result<std::optional<DepthFrame>> next();

 private:
  struct Impl;
  explicit RawlogReader(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace graspd
