#pragma once

#include "graspd/agent/ports.hpp"

namespace graspd::agent {

/// Adds the time until the end of the scope.
class Stopwatch {
 public:
  Stopwatch(Clock& clock, std::chrono::nanoseconds& total)
      : clock_(clock), total_(total), start_(clock.now()) {}
  Stopwatch(const Stopwatch&) = delete;
  Stopwatch& operator=(const Stopwatch&) = delete;
  ~Stopwatch() { total_ += clock_.now() - start_; }

 private:
  Clock& clock_;
  std::chrono::nanoseconds& total_;
  std::chrono::nanoseconds start_;
};

}  // namespace graspd::agent
