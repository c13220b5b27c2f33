#include "joint_limits.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace graspd::motion {
namespace {

bool is_within(double q_rad, const JointLimits& limits) {
  constexpr double kRounding_rad = 1e-9;
  return q_rad >= limits.min_rad - kRounding_rad && q_rad <= limits.max_rad + kRounding_rad;
}

}  // namespace

agent::Joints unwind(agent::Joints q_rad, const agent::Joints& near_rad,
                     std::span<const JointLimits> limits) {
  constexpr double kTurn_rad = 2 * std::numbers::pi;
  for (int j = 0; j < q_rad.size(); ++j) {
    const JointLimits& of = limits[static_cast<std::size_t>(j)];
    const double nearest_rad =
        q_rad[j] + kTurn_rad * std::round((near_rad[j] - q_rad[j]) / kTurn_rad);
    q_rad[j] = nearest_rad;
    if (is_within(nearest_rad, of)) continue;
    const double other_rad = nearest_rad + (nearest_rad > of.max_rad ? -kTurn_rad : kTurn_rad);
    if (is_within(other_rad, of)) q_rad[j] = other_rad;
  }
  return q_rad;
}

std::optional<std::string> beyond_limits(const agent::Joints& q_rad,
                                         std::span<const JointLimits> limits) {
  for (int j = 0; j < q_rad.size(); ++j) {
    const JointLimits& of = limits[static_cast<std::size_t>(j)];
    if (is_within(q_rad[j], of)) continue;
    return fmt::format("{} would be at {:.3f} rad (limits {:.3f} to {:.3f})", of.name, q_rad[j],
                       of.min_rad, of.max_rad);
  }
  return std::nullopt;
}

void sort_by_nearness(std::vector<agent::Joints>& all_rad, const agent::Joints& near_rad) {
  constexpr double kSame_rad = 1e-4;
  std::ranges::stable_sort(
      all_rad, {}, [&](const agent::Joints& q_rad) { return furthest_turn(near_rad, q_rad); });
  std::vector<agent::Joints> kept_rad;
  for (agent::Joints& q_rad : all_rad) {
    const bool is_new = std::ranges::none_of(kept_rad, [&](const agent::Joints& other_rad) {
      return furthest_turn(other_rad, q_rad) < kSame_rad;
    });
    if (is_new) kept_rad.push_back(std::move(q_rad));
  }
  all_rad = std::move(kept_rad);
}

}  // namespace graspd::motion
