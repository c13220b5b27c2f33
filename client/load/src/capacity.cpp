#include "graspd/load/capacity.hpp"

#include <algorithm>

namespace graspd::load {
namespace {

constexpr double kSustainedShare = 0.98;
constexpr double kStep = 1.1;
constexpr double kExact = 1.02;
constexpr int kMostSteps_n = 30;  // 1.1^30 is 17
constexpr double kCurve[]{0.2, 0.4, 0.6, 0.8, 0.9, 1.2};

}  // namespace

bool is_sustained(const Run& run) {
  const Summary& seen = run.summary;
  return seen.ok_n > 0 && seen.goodput_hz >= kSustainedShare * seen.asked_hz && !is_late(seen);
}

Capacity find_capacity(Run peak, const std::function<Run(double rate_hz)>& run_at) {
  Capacity found;
  found.peak = std::move(peak);
  const auto sustains = [&](double rate_hz) {
    found.runs.push_back(run_at(rate_hz));
    return is_sustained(found.runs.back());
  };
  // From the peak up or down until it changes its mind, then between the last two.
  double rate_hz = found.peak.summary.goodput_hz;
  if (rate_hz <= 0) return found;
  const bool was_sustained = sustains(rate_hz);
  double other_hz = rate_hz;
  bool is_between = false;
  for (int i = 0; i < kMostSteps_n && !is_between; ++i) {
    rate_hz = other_hz;
    other_hz = was_sustained ? rate_hz * kStep : rate_hz / kStep;
    is_between = sustains(other_hz) != was_sustained;
  }
  double low_hz = std::min(rate_hz, other_hz);
  double high_hz = std::max(rate_hz, other_hz);
  if (!is_between) low_hz = high_hz = was_sustained ? high_hz : 0;
  while (high_hz > kExact * low_hz) {
    const double middle_hz = (low_hz + high_hz) / 2;
    (sustains(middle_hz) ? low_hz : high_hz) = middle_hz;
  }
  found.capacity_hz = low_hz;
  if (low_hz > 0) {
    for (const double share : kCurve) found.runs.push_back(run_at(share * low_hz));
  }
  std::sort(found.runs.begin(), found.runs.end(),
            [](const Run& a, const Run& b) { return a.rate_hz < b.rate_hz; });
  return found;
}

}  // namespace graspd::load
