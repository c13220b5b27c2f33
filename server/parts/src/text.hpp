#pragma once

#include <fmt/format.h>

#include <Eigen/Core>
#include <string>

namespace graspd::parts {

/// Four digits, without −0 and what a rounding error leaves.
inline std::string in_digits(const Eigen::Vector3d& v) {
  const Eigen::Array3d rounded = (v.array() * 1e3).round() / 1e3 + 0.0;
  return fmt::format("({:.4g}, {:.4g}, {:.4g})", rounded.x(), rounded.y(), rounded.z());
}

inline std::string in_mm(const Eigen::Vector3d& p_m) { return in_digits(p_m * 1e3); }

}  // namespace graspd::parts
