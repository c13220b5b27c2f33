#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "graspd/eval/pose_accuracy.hpp"
#include "graspd/parts/catalogue.hpp"

/// What `./run bench perception` measures: graspd and its peers on the same simulated frames.
namespace graspd::bench {

struct PerceptionOptions {
  int frames_n = 12;      ///< of each part
  int peer_frames_n = 3;  ///< the first of them: those pipelines take seconds a frame
  int parts_per_frame_n = 45;
  std::uint64_t seed = 1;  ///< of the first frame; everything was tuned on 1000 and up
};

/// One method on one frame.
struct Run {
  std::string part_id;
  int frame = 0;
  double camera_height_m = 0;
  std::string task;  ///< kSegmentation or kPoses
  std::string method;
  /// Of the processor, which other work beside does not change; of the clock where there are two
  /// cores.
  double time_ms = 0;
  int objects_n = 0;  ///< visible by half or more
  int found_n = 0;    ///< of these
  std::optional<eval::PoseAccuracy> poses;
};

inline constexpr const char* kSegmentation = "segmentation";
inline constexpr const char* kPoses = "poses";
inline constexpr const char* kGraspd = "graspd";             ///< with its defaults, on one core
inline constexpr const char* kGraspd2 = "graspd_two_cores";  ///< the same on two
inline constexpr const char* kPaper = "graspd_paper";        ///< improved DBSCAN and PCA with ICP

/// \returns the first failure to make a frame or to plan it.
Result<std::vector<Run>> measure(const parts::Catalogue& catalogue,
                                 const PerceptionOptions& options);

}  // namespace graspd::bench
