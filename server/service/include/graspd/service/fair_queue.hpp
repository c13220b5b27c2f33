#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace graspd::service {

using Clock = std::chrono::steady_clock;
using TimePoint = Clock::time_point;
/// The front's own number of a request.
using Ticket = std::uint64_t;

/// A request in the queue.
struct Waiting {
  Ticket ticket = 0;
  std::string cell;
  TimePoint deadline;
};

/// Whose turn it is. One queue for all cells lets a noisy cell push a quiet one to seconds; here
/// each cell has a short queue of its own, and cells take turns. A pile that has been picked from
/// makes its older frames worthless, so the latest frame of a cell wins the place of its oldest.
///
/// Guarantees: a cell of which nothing runs waits for one request of each other cell at most, one
/// that runs already included (one worker); between two starts of a waiting cell, every other cell
/// starts at most one request (where shares allow); no cell holds more than a quarter of the
/// workers while a cell below its share waits; a worker is never left idle while anything waits.
/// Not thread-safe; knows no clock.
class FairQueue {
 public:
  FairQueue(std::size_t depth_per_cell, std::size_t workers_n);

  /// \returns the oldest request of the same cell, where it lost its place to this one.
  std::optional<Waiting> push(Waiting request);
  /// Takes the next request out; its cell holds one worker more until `finish`.
  std::optional<Waiting> start();
  /// What this cell had started has ended.
  void finish(const std::string& cell);
  /// Takes out what nobody waits for any more.
  std::vector<Waiting> expire(TimePoint now);
  /// Empties the queue; \returns what was in it.
  std::vector<Waiting> clear();

  std::optional<TimePoint> earliest_deadline() const;
  std::size_t queued_n() const;
  std::size_t running_n() const;
  /// How many of the queued requests would start before one that this cell pushed now.
  std::size_t ahead_of(const std::string& cell) const;

 private:
  struct Cell {
    std::deque<Waiting> queue;
    std::size_t running_n = 0;
  };
  std::size_t joining_turn(const Cell& cell) const;
  void forget_if_idle(const std::string& cell);

  std::size_t depth_per_cell_;
  std::size_t share_n_;
  std::map<std::string, Cell> cells_;
  std::deque<std::string> turns_;  ///< the cells that wait, the next one first
};

}  // namespace graspd::service
