#include "graspd/agent/drift_alarm.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace graspd::agent {

std::optional<std::string> DriftAlarm::see(const PlanAnswer& answer) {
  if (answer.bin_drift_m.value_or(0) <= policy_.limit_m) {
    drifts_m_.clear();
    is_raised_ = false;
    return std::nullopt;
  }
  ++over_limit_n_;
  drifts_m_.push_back(*answer.bin_drift_m);
  if (drifts_m_.size() > policy_.answers_n) drifts_m_.pop_front();
  if (is_raised_ || drifts_m_.size() < policy_.answers_n) return std::nullopt;
  is_raised_ = true;
  const auto [least, most] = std::minmax_element(drifts_m_.begin(), drifts_m_.end());
  return fmt::format(
      "the bin was {:.1f} to {:.1f} mm off in {} frames in a row: has the camera been knocked? "
      "Calibrate it again, or put the bin back",
      *least * 1e3, *most * 1e3, drifts_m_.size());
}

}  // namespace graspd::agent
