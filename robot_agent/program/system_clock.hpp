#pragma once

#include <time.h>

#include "graspd/agent/ports.hpp"

namespace graspd::robot_agent {

/// The machine's own time. A signal ends a sleep early, so that the program answers to Ctrl-C.
class SystemClock final : public agent::Clock {
 public:
  std::chrono::nanoseconds now() override {
    return std::chrono::steady_clock::now().time_since_epoch();
  }
  void sleep_for(std::chrono::nanoseconds duration) override {
    const auto seconds = std::chrono::duration_cast<std::chrono::seconds>(duration);
    const timespec time{seconds.count(), (duration - seconds).count()};
    nanosleep(&time, nullptr);
  }
};

}  // namespace graspd::robot_agent
