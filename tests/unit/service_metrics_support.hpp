#pragma once

#include <string>

#include "http_get.hpp"
#include "metrics_text.hpp"
#include "service_front_support.hpp"

namespace graspd::service {

/// What Prometheus would read of a front now.
inline testing::MetricsText read(const RunningFront& front) {
  const auto page = testing::http_get(front.http_url, "/metrics");
  EXPECT_EQ(page.status, 200);
  return testing::parse_metrics(page.body);
}

/// The name of a series.
inline std::string answers(const std::string& cell, const std::string& code) {
  return "graspd_answers_total{cell=\"" + cell + "\",code=\"" + code + "\"}";
}

}  // namespace graspd::service
