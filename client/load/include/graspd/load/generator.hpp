#pragma once

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "graspd/client/client.hpp"

namespace graspd::load {

using client::Clock;
using client::TimePoint;

/// A robot cell that is simulated.
struct Cell {
  std::string name;
  std::optional<keys::ClientKeys> keys;
  /// Asked one after another, over and over, by each cell from another one on. Many cells may have
  /// the same ones.
  std::shared_ptr<const std::vector<client::PreparedPlan>> plans;
};

/// One request, as it was planned.
struct Asked {
  RequestId id{};
  std::size_t cell = 0;
  std::size_t plan = 0;  ///< of the cell's
  TimePoint planned;     ///< the instant its time counts from
  std::chrono::milliseconds budget{0};
};

/// The same request, and what became of it.
struct Ended : Asked {
  TimePoint handed_over;  ///< to the client
  client::PlanEnd end;
};

/// Who hears of every request.
struct Observer {
  std::function<void(const Asked&)> asked;  ///< before it is sent
  std::function<void(const Ended&)> ended;  ///< once, from any thread; must not wait
};

/// Whom the cells ask, and for how long.
struct GeneratorOptions {
  std::vector<std::string> endpoints;
  std::chrono::milliseconds budget{10'000};  ///< from the planned instant
  client::DispatchOptions dispatch{};
};

/// The clients of many cells, in one process, each with a connection of its own to each server.
/// Asking never waits, so when to ask is never a matter of how fast the servers are.
class Generator {
 public:
  /// \throws std::invalid_argument for an endpoint that is none, and for a cell without plans.
  Generator(std::vector<Cell> cells, const GeneratorOptions& options, Observer observer);
  ~Generator();
  Generator(const Generator&) = delete;
  Generator& operator=(const Generator&) = delete;

  std::size_t cells_n() const { return cells_.size(); }
  /// Asks all servers how they are, for each cell: who is there is connected from here on.
  void connect();
  /// Asks the cell's next plan, whatever of its own is in flight.
  /// \param then called after the observer, from a thread of the client's
  void ask(std::size_t cell, TimePoint planned, std::function<void()> then = {});
  /// Until every request has ended.
  void wait_until_idle();

 private:
  struct Seat {
    Cell cell;
    std::atomic<std::size_t> asked_n = 0;
    std::unique_ptr<client::Client> client;
  };

  Observer observer_;
  std::chrono::milliseconds budget_;
  std::mutex mutex_;
  std::condition_variable ended_;
  std::size_t in_flight_n_ = 0;  ///< guarded by mutex_
  std::vector<std::unique_ptr<Seat>> cells_;
};

/// Asks again as soon as an answer is there: so many requests of each cell are always in flight.
class ClosedLoop {
 public:
  ClosedLoop(Generator& generator, int in_flight_n);
  /// Waits for what is in flight.
  ~ClosedLoop() { stop(); }
  ClosedLoop(const ClosedLoop&) = delete;
  ClosedLoop& operator=(const ClosedLoop&) = delete;

  /// No further requests; waits for what is in flight.
  void stop();

 private:
  void ask(std::size_t cell);

  Generator& generator_;
  std::atomic<bool> stop_ = false;
};

}  // namespace graspd::load
