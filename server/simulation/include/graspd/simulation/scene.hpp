#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "graspd/formats/bop.hpp"
#include "graspd/parts/catalogue.hpp"
#include "graspd/simulation/kinect_v2.hpp"
#include "graspd/simulation/pile.hpp"

namespace graspd::simulation {

struct PartCount {
  std::string part_id;
  int count_n = 0;
};

/// What a simulated scene is made of. Frame k has the seed `seed + k`, whatever the other frames.
struct SceneOptions {
  std::vector<PartCount> parts;
  int frames_n = 1;
  std::uint64_t seed = 1;
  Eigen::Vector3d bin_inner_size_m{0.30, 0.24, 0.12};
  double bin_wall_m = 0.005;
  double camera_height_m = 0.75;  ///< above the bin's floor
  double camera_tilt_rad = 0;     ///< about the bin's x axis, still towards the bin's centre
  double gloss = 0;               ///< of the parts; see SceneObject
  int looks_n = 1;                ///< of which each frame is the mean; at most kMaxMeanFrames
  KinectV2Parameters sensor;
};

/// T_bin_camera of a camera that looks at the centre of the bin's floor.
Eigen::Isometry3d camera_over_bin(double height_m, double tilt_rad);

/// Piles and frames of one set of parts. The convex pieces are cut once.
class SceneMaker {
 public:
  /// \returns UNKNOWN_PART for a part that the catalogue does not have, INVALID_ARGUMENT for
  /// options that make no scene. The catalogue must outlive the maker.
  static Result<SceneMaker> create(const parts::Catalogue& catalogue, SceneOptions options);

  /// The frame with its true poses, visible fractions and instance ids; `k` is its BOP number.
  /// Parts that would not stay in the bin are left out. Any number of threads may call it.
  Result<BopImage> make(int k) const;

 private:
  SceneMaker(SceneOptions options, std::vector<const parts::Part*> kinds, PileMaker piles);

  SceneOptions options_;
  std::vector<const parts::Part*> kinds_;
  PileMaker piles_;
  parts::Mesh bin_;
};

}  // namespace graspd::simulation
