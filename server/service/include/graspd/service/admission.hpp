#pragma once

#include <cstdint>
#include <optional>
#include <random>
#include <string>
#include <vector>

#include "graspd/service/fair_queue.hpp"
#include "graspd/types/result.hpp"

namespace graspd::service {

/// A "no" to one request, with when to come back.
struct Refusal {
  Error error;
  std::uint32_t retry_after_ms = 0;
};

/// Decides which requests are worth starting, and in which order. A request that would wait longer
/// than its budget is refused at once, while its sender can still go elsewhere; one whose deadline
/// has passed is never started.
///
/// Not thread-safe. Time comes in with each call; the random generator (for the jitter that keeps
/// refused clients from coming back all at once) is seeded by the caller.
class Admission {
 public:
  static constexpr std::size_t kDepthPerCell = 2;

  /// \param seed of the jitter.
  Admission(std::size_t workers_n, std::uint64_t seed);

  /// On a request that has come.
  struct Verdict {
    std::optional<Refusal> refusal;
    std::optional<Ticket> superseded;  ///< an older request of this cell, out of the queue now
  };
  /// Queues it. Refuses it with BUSY where it would wait longer than its deadline allows, with
  /// DEADLINE_EXCEEDED where that has passed.
  Verdict admit(Waiting request, TimePoint now);

  /// The next request to start, if any.
  std::optional<Ticket> start(TimePoint now);
  /// A started request has ended; `computed` where its time says something of the next one's.
  void finish(Ticket ticket, TimePoint now, bool computed);
  /// Takes out of the queue what has passed its deadline.
  std::vector<Ticket> expire(TimePoint now);
  /// Empties the queue.
  std::vector<Ticket> clear();

  std::optional<TimePoint> earliest_deadline() const { return queue_.earliest_deadline(); }
  std::size_t queued_n() const { return queue_.queued_n(); }
  std::size_t running_n() const { return running_.size(); }
  /// How long a request that this cell sent now would wait to be started: 0 where a worker is free,
  /// or nothing is known yet of how long one takes.
  std::chrono::nanoseconds predicted_wait(const std::string& cell) const;

 private:
  struct Running {
    std::string cell;
    TimePoint started;
  };

  std::size_t workers_n_;
  FairQueue queue_;
  std::map<Ticket, Running> running_;
  std::optional<std::chrono::nanoseconds> mean_service_time_;
  std::mt19937_64 random_;
};

}  // namespace graspd::service
