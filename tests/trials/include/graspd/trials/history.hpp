#pragma once

#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <map>
#include <mutex>
#include <string>
#include <vector>

#include "graspd/types/envelope.hpp"

namespace graspd::trials {

using Clock = std::chrono::steady_clock;
using TimePoint = Clock::time_point;

/// How requests ended, in all.
struct Tally {
  int asked_n = 0;
  std::map<Code, int> ended_n;
  std::vector<double> ok_ms;  ///< of those that were OK, sorted

  int ok_n() const;
  /// Of `ok_ms`; 0 where there are none. \param share 0.5 is the median, 1 the worst
  double quantile_ms(double share) const;
};

/// Everything that clients asked and got, and whether it is what SERVICE.md promises:
/// each request ends once, within its budget and 100 ms (P1); the same question has the same answer
/// on every server (P2); no answer is another question's.
/// All members may be called from any thread.
class History {
 public:
  static constexpr std::chrono::milliseconds kSlack{100};

  /// \param question equal numbers are equal frames and requests
  void asked(const RequestId& id, std::uint32_t question, TimePoint at,
             std::chrono::milliseconds budget);
  /// \param question the one that the answer says it answers
  /// \param digest of everything in the answer but its times
  void answered(const RequestId& id, TimePoint at, std::uint32_t question, std::uint64_t digest);
  /// A server's refusal, or the client's own.
  void refused(const RequestId& id, TimePoint at, Code code);

  /// A sentence for each promise that was broken. Says of what has not ended that it is silent:
  /// look when nothing is in flight.
  std::vector<std::string> violations() const;
  Tally tally() const;
  /// Until so many more requests have ended.
  void wait_for(std::size_t requests_n) const;

 private:
  struct End {
    RequestId id{};
    TimePoint at;
    Code code = Code::kOk;
    std::uint32_t question = 0;  ///< where OK
    std::uint64_t digest = 0;    ///< where OK
  };
  struct Question {
    std::uint32_t number = 0;
    TimePoint at;
    std::chrono::milliseconds budget{0};
  };

  void end(const End& end);

  mutable std::mutex mutex_;
  mutable std::condition_variable changed_;
  std::multimap<RequestId, Question> asked_;
  std::vector<End> ended_;
};

}  // namespace graspd::trials
