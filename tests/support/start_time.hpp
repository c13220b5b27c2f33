#pragma once

#include "graspd/service/fair_queue.hpp"

namespace graspd::service {

/// When a test starts, with room before it.
inline const TimePoint kStart{std::chrono::seconds(1000)};

}  // namespace graspd::service
