#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "graspd/simulation/pile.hpp"

namespace graspd::simulation {

/// Who bears whom, in a pile at rest.
struct Bearing {
  std::uint32_t upper = 0, lower = 0;  ///< indices into the pile
  double share = 0;                    ///< of the upper part's weight: the lower one's upward force
};

/// How another part moved while one was lifted.
struct Moved {
  double rise_m = 0;  ///< of its centre of mass, at the end
  double way_m = 0;   ///< of its centre of mass, at its farthest
};

/// How a part is pulled out of the pile.
struct LiftOptions {
  double height_m = 0.10;
  double speed_m_s = 0.3;
};

/// What physics says of a pile whose poses are known: the truth that a graph of the pile is
/// measured against. Any number of threads may ask.
class PilePhysics {
 public:
  explicit PilePhysics(const std::vector<parts::Mesh>& kinds, const PileOptions& options = {});
  PilePhysics(PilePhysics&&) noexcept;
  PilePhysics& operator=(PilePhysics&&) noexcept;
  ~PilePhysics();

  /// Upward forces between the parts, averaged over a moment. Floor and walls are left out.
  std::vector<Bearing> bearings(std::span<const PiledPart> pile,
                                const Eigen::Vector3d& bin_inner_size_m) const;

  /// Lifts one part straight up, as a gripper would that never lets go.
  /// \returns one for each part; the lifted one's own is its way up.
  std::vector<Moved> lift(std::size_t lifted, std::span<const PiledPart> pile,
                          const Eigen::Vector3d& bin_inner_size_m,
                          const LiftOptions& options = {}) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace graspd::simulation
