#pragma once

namespace graspd::eval {

/// Objects of which a smaller fraction is visible neither help nor hurt (Brégier 2017).
inline constexpr double kMinVisible = 0.5;

}  // namespace graspd::eval
