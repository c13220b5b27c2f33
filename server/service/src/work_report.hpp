#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "graspd/types/envelope.hpp"

namespace graspd::service {

/// What a worker tells the front of a request beside the encoded answer, which the front does not
/// read: for metrics and log.
struct WorkReport {
  std::string message;             ///< the outcome's reason, or the refusal's sentence
  std::optional<Outcome> outcome;  ///< nothing where there is no plan
  std::size_t objects_n = 0;
  std::size_t grasps_n = 0;
  std::vector<StageTiming> timings;
};

WorkReport report_of(const Answer& answer);
std::string encode(const WorkReport& report);
/// \throws std::exception for what `encode` did not write.
WorkReport decode_work_report(std::string_view text);

}  // namespace graspd::service
