#include "pile_measures.hpp"

#include <algorithm>

namespace graspd::bench {
namespace {

constexpr double kBears = 0.1;  ///< of a part's weight
constexpr double kTakenAlong_m = 0.03;

}  // namespace

PileTruth::PileTruth(const simulation::Pile& pile, const Eigen::Vector3d& bin_inner_size_m,
                     const std::vector<const parts::Part*>& kinds,
                     const simulation::PilePhysics& physics)
    : physics_(&physics), bin_inner_size_m_(bin_inner_size_m), piled_(pile.parts) {
  for (const simulation::PiledPart& part : piled_) {
    parts_.push_back({kinds[part.kind], part.T_bin_part});
  }
  for (const simulation::Bearing& bearing : physics.bearings(piled_, bin_inner_size_m_)) {
    shares_[{bearing.upper, bearing.lower}] = bearing.share;
  }
}

bool PileTruth::lies_on(std::size_t upper, std::size_t lower) const {
  const auto share = [&](std::size_t a, std::size_t b) {
    const auto found = shares_.find({a, b});
    return found == shares_.end() ? 0 : found->second;
  };
  return share(upper, lower) >= kBears && share(upper, lower) >= share(lower, upper);
}

bool PileTruth::is_supporting(std::size_t part) const {
  for (std::size_t upper = 0; upper < parts_.size(); ++upper) {
    if (upper != part && lies_on(upper, part)) return true;
  }
  return false;
}

const std::vector<simulation::Moved>& PileTruth::lift(std::size_t part) const {
  auto found = lifts_.find(part);
  if (found == lifts_.end()) {
    found = lifts_.emplace(part, physics_->lift(part, piled_, bin_inner_size_m_)).first;
    found->second[part] = {};
  }
  return found->second;
}

double PileTruth::disturbance_m(std::size_t part) const {
  return std::ranges::max(lift(part), {}, &simulation::Moved::way_m).way_m;
}

bool PileTruth::takes_along(std::size_t part) const {
  return std::ranges::max(lift(part), {}, &simulation::Moved::rise_m).rise_m > kTakenAlong_m;
}

double Separation::auc() const {
  double larger_n = 0;
  for (const double a : true_) {
    for (const double b : false_) larger_n += a > b ? 1 : a == b ? 0.5 : 0;
  }
  return larger_n / static_cast<double>(true_.size() * false_.size());
}

Separation::Threshold Separation::at(double value) const {
  const auto share_above = [&](const std::vector<double>& values) {
    const auto above_n = std::ranges::count_if(values, [&](double v) { return v > value; });
    return static_cast<double>(above_n) / static_cast<double>(values.size());
  };
  return {value, share_above(true_), share_above(false_)};
}

Separation::Threshold Separation::best() const {
  Threshold best = at(0);
  for (const double value : true_) {
    const Threshold next = at(value);
    if (next.hit_rate - next.false_alarm_rate > best.hit_rate - best.false_alarm_rate) best = next;
  }
  return best;
}

}  // namespace graspd::bench
