#pragma once

#include <stdexcept>
#include <vector>

#include "graspd/agent/ports.hpp"

namespace graspd::agent::fakes {

/// Stands still but for what it is told, and remembers who slept.
class FakeClock final : public Clock {
 public:
  std::chrono::nanoseconds now() override { return now_; }
  void sleep_for(std::chrono::nanoseconds duration) override {
    if (breaks) throw std::runtime_error("the clock");
    sleeps.push_back(std::chrono::duration_cast<std::chrono::milliseconds>(duration));
    now_ += duration;
  }
  void advance(std::chrono::nanoseconds duration) { now_ += duration; }

  std::vector<std::chrono::milliseconds> sleeps;
  bool breaks = false;

 private:
  std::chrono::nanoseconds now_{1};
};

}  // namespace graspd::agent::fakes
