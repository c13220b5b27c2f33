#include "graspd/load/pace.hpp"

#include <fmt/format.h>
#include <sys/prctl.h>

#include <algorithm>
#include <queue>
#include <random>
#include <stdexcept>
#include <thread>

namespace graspd::load {
namespace {

TimePoint after(TimePoint start, double time_s) {
  return start + std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(time_s));
}

/// Linux wakes a thread up to 50 µs late unless told otherwise.
class ExactTimers {
 public:
  ExactTimers() : before_ns_(prctl(PR_GET_TIMERSLACK)) { prctl(PR_SET_TIMERSLACK, 1UL); }
  ~ExactTimers() { prctl(PR_SET_TIMERSLACK, static_cast<unsigned long>(before_ns_)); }
  ExactTimers(const ExactTimers&) = delete;
  ExactTimers& operator=(const ExactTimers&) = delete;

 private:
  int before_ns_;
};

/// One pass through a recording, and the pause before the next: as long as between frames.
double period_s(const std::vector<double>& stamps_s) {
  const double length_s = stamps_s.back() - stamps_s.front();
  return length_s + length_s / static_cast<double>(stamps_s.size() - 1);
}

}  // namespace

Pace fixed_pace(TimePoint start, double rate_hz, std::size_t cells_n) {
  return [=, i = std::size_t{0}]() mutable {
    const Due due{after(start, static_cast<double>(i) / rate_hz), i % cells_n};
    ++i;
    return due;
  };
}

Pace poisson_pace(TimePoint start, double rate_hz, std::size_t cells_n, std::uint64_t seed) {
  // All cells' instants together are a Poisson process again, in which each cell is as likely.
  return [=, random = std::mt19937_64(seed), time_s = 0.0]() mutable {
    time_s += std::exponential_distribution<double>(rate_hz)(random);
    return Due{after(start, time_s),
               std::uniform_int_distribution<std::size_t>(0, cells_n - 1)(random)};
  };
}

Pace recorded_pace(TimePoint start, std::vector<std::vector<double>> stamps_s) {
  struct Next {
    double time_s = 0;
    std::size_t cell = 0;
    std::size_t frame_n = 0;
    bool operator>(const Next& other) const { return time_s > other.time_s; }
  };
  std::priority_queue<Next, std::vector<Next>, std::greater<>> next;
  for (std::size_t cell = 0; cell < stamps_s.size(); ++cell) {
    const std::vector<double>& own_s = stamps_s[cell];
    const bool grow =
        std::adjacent_find(own_s.begin(), own_s.end(), std::greater_equal<>()) == own_s.end();
    if (own_s.size() < 2 || !grow) {
      throw std::invalid_argument(
          fmt::format("the frames of cell {} don't say when each was taken, one after the other: "
                      "say a rate instead of the recorded pace",
                      cell));
    }
    next.push({0, cell, 0});
  }
  return [start, stamps_s = std::move(stamps_s), next = std::move(next)]() mutable {
    const Next due = next.top();
    next.pop();
    const std::vector<double>& own_s = stamps_s[due.cell];
    const std::size_t frame_n = due.frame_n + 1;
    const std::size_t rounds_n = frame_n / own_s.size();
    const double round_s = static_cast<double>(rounds_n) * period_s(own_s);
    next.push({round_s + own_s[frame_n % own_s.size()] - own_s.front(), due.cell, frame_n});
    return Due{after(start, due.time_s), due.cell};
  };
}

void run_open_loop(Generator& generator, const Pace& pace,
                   const std::function<bool(const Due&)>& go_on) {
  const ExactTimers exact;
  for (Due due = pace(); go_on(due); due = pace()) {
    std::this_thread::sleep_until(due.at);
    generator.ask(due.cell, due.at);
  }
}

}  // namespace graspd::load
