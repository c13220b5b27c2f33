#pragma once

#include <Eigen/Geometry>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <utility>

namespace graspd::simulation {

/// SplitMix64 (Steele, Lea, Flood 2014). Ours rather than the standard library's, whose
/// distributions differ between implementations: a seed must mean the same scene everywhere.
class Random {
 public:
  explicit Random(std::uint64_t seed) : state_(seed) {}
  /// An independent stream for one item of many: a pixel, a frame, an attempt.
  Random(std::uint64_t seed, std::uint64_t stream) : state_(mix(seed) ^ mix(~stream)) {}

  std::uint64_t next() { return mix(state_ += 0x9E3779B97F4A7C15ULL); }

  /// In [0, 1).
  double uniform() { return double(next() >> 11) * 0x1.0p-53; }
  double uniform(double low, double high) { return low + (high - low) * uniform(); }

  /// Two independent standard normal numbers (Box and Muller).
  std::pair<double, double> normal_pair() {
    const double radius = std::sqrt(-2 * std::log(1 - uniform()));
    const double angle = 2 * std::numbers::pi * uniform();
    return {radius * std::cos(angle), radius * std::sin(angle)};
  }

  /// Uniform over all rotations: a normalised 4-vector of normal numbers.
  Eigen::Quaterniond rotation() {
    const auto [w, x] = normal_pair();
    const auto [y, z] = normal_pair();
    return Eigen::Quaterniond(w, x, y, z).normalized();
  }

 private:
  static std::uint64_t mix(std::uint64_t z) {
    z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9ULL;
    z = (z ^ (z >> 27)) * 0x94D049BB133111EBULL;
    return z ^ (z >> 31);
  }

  std::uint64_t state_;
};

}  // namespace graspd::simulation
