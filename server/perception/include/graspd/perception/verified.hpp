#pragma once

#include "graspd/perception/registration.hpp"

namespace graspd::perception {

/// Verified registration: segments may propose, but must not decide.
///
/// 1. Hypotheses: a surface reading with its normal, laid on each anchor of each part and turned
///    about the normal; those that the first points of their view do not refute are kept.
/// 2. Projective ICP and verification make the best of each place better.
/// 3. Explanation of the image: the best pose is accepted and claims its pixels, which from then on
///    speak for no other; then the next.
///
/// Both cores of the caller's arena work on it; the result does not depend on how many.
RegistrationResult register_verified(const DepthFrame& frame, const Scene& scene,
                                     std::span<const Indices> segments,
                                     std::span<const parts::Part* const> parts,
                                     const Parameters& parameters);

}  // namespace graspd::perception
