#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "graspd/perception/is_late.hpp"
#include "graspd/perception/pose_hypothesis.hpp"

namespace graspd::perception {

/// What `find_hypotheses` found.
struct HypothesesFound {
  std::vector<PoseHypothesis> poses;  ///< roughly placed and scored, best first
  std::uint64_t compared_n = 0;       ///< of templates in a turn with the image around a reading
};

/// Poses that may be right.
///
/// 1. Seeds: of each square of the image the reading in the middle of most surface.
/// 2. At each seed, templates of each part whose anchor's normal about agrees; the best are
///    compared with the image at more points.
/// 3. Of each place the best few, made better by projective ICP.
///
/// Works in parallel within the caller's TBB arena; the result does not depend on its size. Once it
/// is late, what was found so far.
HypothesesFound find_hypotheses(const DepthGrid& grid, const PoseVerifier& verifier,
                                std::span<const parts::Part* const> parts,
                                const RegistrationParameters& parameters,
                                const IsLate& is_late = never_late);

}  // namespace graspd::perception
