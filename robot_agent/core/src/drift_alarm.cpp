#include "graspd/agent/drift_alarm.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <string_view>

namespace graspd::agent {
namespace {

std::optional<double> drift_in(const std::string& sentence) {
  constexpr std::string_view kBegin = "the bin lies ";
  constexpr std::string_view kRim = "its rim by up to ";
  if (!sentence.starts_with(kBegin)) return std::nullopt;
  const auto at = sentence.find(kRim);
  if (at == std::string::npos) return std::nullopt;
  return std::strtod(sentence.c_str() + at + kRim.size(), nullptr) * 1e-3;
}

}  // namespace

std::optional<double> bin_drift_m(const PlanAnswer& answer) {
  for (const std::string& warning : answer.warnings) {
    if (const auto drift_m = drift_in(warning)) return drift_m;
  }
  return drift_in(answer.reason);
}

std::optional<std::string> DriftAlarm::see(const PlanAnswer& answer) {
  const auto drift_m = bin_drift_m(answer);
  if (!drift_m || *drift_m <= policy_.limit_m) {
    drifts_m_.clear();
    is_raised_ = false;
    return std::nullopt;
  }
  ++over_limit_n_;
  drifts_m_.push_back(*drift_m);
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
