#pragma once

#include <cstdint>
#include <deque>
#include <optional>
#include <string>

#include "graspd/types/answer.hpp"

namespace graspd::agent {

/// When a drift counts as one.
struct DriftPolicy {
  double limit_m = 0.006;
  std::uint32_t answers_n = 5;  ///< in a row
};

/// Watches the known bin for a camera that has been knocked, or a bin that creeps: one frame may be
/// wrong, several in a row mean that the calibration no longer holds. Whether to warn or to stop is
/// the caller's choice.
class DriftAlarm {
 public:
  explicit DriftAlarm(const DriftPolicy& policy) : policy_(policy) {}

  /// \returns the alarm, a sentence, when so many answers in a row were over the limit. It is
  /// raised once, and again only after the bin was where it should be.
  std::optional<std::string> see(const PlanAnswer& answer);
  std::size_t over_limit_n() const { return over_limit_n_; }  ///< of all answers

 private:
  DriftPolicy policy_;
  std::deque<double> drifts_m_;  ///< of the answers in a row
  std::size_t over_limit_n_ = 0;
  bool is_raised_ = false;
};

}  // namespace graspd::agent
