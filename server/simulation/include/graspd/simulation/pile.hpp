#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <memory>
#include <vector>

#include "graspd/parts/mesh.hpp"
#include "graspd/types/result.hpp"

namespace graspd::simulation {

/// Of parts that fall, and of the physics' steps.
struct PileOptions {
  double density_kg_m3 = 1100;  ///< ABS, as injection-moulded fittings
  double friction = 0.4;
  double restitution = 0.05;
  double step_s = 1.0 / 120;
  double drop_every_s = 0.05;
  double drop_speed_m_s = 0.6;  ///< and never faster: thin walls must not pass through each other
  double still_speed_m_s = 0.005;
  double still_for_s = 0.25;
  double settle_within_s = 8;
  double max_penetration_m = 0.0005;
  int max_drops_n = 4;     ///< how often a part that fell beside the bin is dropped again
  int max_attempts_n = 3;  ///< how often a pile that does not come to rest is dropped anew
};

struct PiledPart {
  std::size_t kind = 0;
  Eigen::Isometry3d T_bin_part = Eigen::Isometry3d::Identity();
};

/// Parts at rest in a bin, and what it took.
struct Pile {
  std::vector<PiledPart> parts;
  int dropped_again_n = 0;  ///< drops of parts that had fallen beside the bin
  int removed_n = 0;        ///< parts that still lay beside it after `max_drops_n`: left out
  double deepest_penetration_m = 0;
  double simulated_s = 0;
};

/// Makes piles of parts by rigid-body physics: the parts fall one by one, in random order and
/// turned at random, into a bin of five boxes, and lie still. Each kind of part is cut into convex
/// pieces once, at construction. The same seed gives the same pile, to the last bit, on the same
/// machine. `drop` may be called from several threads.
class PileMaker {
 public:
  explicit PileMaker(const std::vector<parts::Mesh>& kinds, const PileOptions& options = {});
  PileMaker(PileMaker&&) noexcept;
  PileMaker& operator=(PileMaker&&) noexcept;
  ~PileMaker();

  /// `counts[k]` parts of kind k. The bin's origin is the centre of its floor, z up.
  /// \returns INVALID_ARGUMENT where the counts do not fit the kinds, or the bin has no size;
  /// INTERNAL where no attempt came to rest without deep penetration.
  Result<Pile> drop(const std::vector<int>& counts, const Eigen::Vector3d& bin_inner_size_m,
                    std::uint64_t seed) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace graspd::simulation
