#pragma once

#include "graspd/perception/is_late.hpp"
#include "graspd/perception/registration.hpp"

namespace graspd::perception {

/// Times the image is searched. Before the second, what explains most of it is out of the way: on
/// tuning frames that found 2 in 100 more parts; a third time found hardly any.
inline constexpr int kLooks = 2;

/// Verified registration: segments may propose, but must not decide.
///
/// 1. Hypotheses: the image around a reading, compared with what a camera sees around a point of
///    the part from each side (see `find_hypotheses`).
/// 2. The best of them say how far the bin's walls still bow the image; that is taken out of the
///    scene's readings, too (see `find_wall_bow_m`).
/// 3. Projective ICP and verification place the best of them.
/// 4. Explanation of the image: the pose that explains most is accepted and claims its pixels,
///    which from then on speak for no other; then the next (see `explain`).
/// 5. What the found parts together leave unexplained says how probable each of them is (see
///    `weigh_in_bin`).
///
/// Both cores of the caller's arena work on it; the result does not depend on how many.
/// Once it is late, what was found so far.
RegistrationResult register_verified(const DepthFrame& frame, Scene& scene,
                                     std::span<const Indices> segments,
                                     std::span<const parts::Part* const> parts,
                                     const Parameters& parameters,
                                     const IsLate& is_late = never_late);

}  // namespace graspd::perception
