#pragma once

#include <chrono>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "graspd/service/fair_queue.hpp"
#include "graspd/service/launcher.hpp"

namespace graspd::service {

/// How long a worker may take for what.
struct SupervisorLimits {
  std::chrono::milliseconds start{60'000};        ///< from launch to READY
  std::chrono::milliseconds silence{5'000};       ///< between heartbeats of an idle worker
  std::chrono::milliseconds job{30'000};          ///< of computing one request
  std::chrono::milliseconds first_back_off{100};  ///< after a failed start; doubles with each
  std::chrono::milliseconds last_back_off{5'000};
  int failed_starts_n = 5;  ///< in a row, before any worker was ready
};

/// Keeps N workers running: launches them, hands requests to idle ones, ends those that hang, and
/// replaces those that died. A worker that dies costs the request it held, and that request gets an
/// answer. Time comes in with each call; not thread-safe.
class Supervisor {
 public:
  /// \param name what its workers' names begin with; no two supervisors on one endpoint share it
  Supervisor(std::size_t workers_n, std::string endpoint, WorkerLauncher& launcher,
             SupervisorLimits limits, std::string name = "worker");

  /// A request whose worker has died, and of what.
  struct Lost {
    Ticket ticket = 0;
    std::string reason;
  };
  /// What `tend` came upon.
  struct Report {
    std::vector<Lost> lost;            ///< requests whose worker has died
    std::vector<std::string> notices;  ///< for the log
  };
  /// Launches, reaps and ends workers as is due.
  /// \throws std::runtime_error where workers keep dying before any was ready.
  Report tend(TimePoint now);
  /// When to call `tend` again, where no exit_fd becomes readable before.
  TimePoint next_tend() const;
  /// To be polled: readable means that `tend` has something to do.
  std::vector<int> exit_fds() const;
  /// Of the workers that are processes.
  std::vector<int> pids() const;

  /// A worker has said something. \returns false for one that is not ours (any more).
  bool heard(const std::string& identity, TimePoint now);
  /// It has passed its golden frame, where there is one, and may get work.
  void ready(const std::string& identity);
  /// Ends a worker that may not work here; `reason` ends in the log.
  void reject(const std::string& identity, const std::string& reason);
  /// An idle worker has been told to stop, and is ended where it does not.
  void dismiss(const std::string& identity, TimePoint now);

  /// The idle worker that has rested longest.
  std::optional<std::string> idle() const;
  /// \param identity of an idle worker; its time limit for the job runs from now.
  void assign(const std::string& identity, Ticket ticket, TimePoint now);
  /// The worker has finished; \returns what it held.
  std::optional<Ticket> release(const std::string& identity, TimePoint now);

  /// Nobody is launched any more; who is gone stays gone.
  void retire() { retired_ = true; }
  bool all_ready() const { return ready_n() == workers_.size(); }

  std::vector<std::string> identities() const;
  std::size_t ready_n() const;
  std::size_t busy_n() const;

 private:
  enum class State { kAbsent, kStarting, kIdle, kBusy, kLeaving, kDoomed };
  struct Worker {
    std::string identity;
    std::unique_ptr<WorkerHandle> handle;
    State state = State::kAbsent;
    TimePoint since;  ///< of the state; for an absent worker when to launch it
    TimePoint last_heard;
    Ticket ticket = 0;
    bool holds_ticket = false;
    bool was_ready = false;
    std::string doom;  ///< why we ended it
  };
  Worker* find(const std::string& identity);
  void launch(Worker& worker, std::size_t slot, TimePoint now);
  void bury(Worker& worker, const std::string& reason, TimePoint now, Report& report);
  void check_limits(Worker& worker, TimePoint now);
  void doom(Worker& worker, std::string reason);
  std::chrono::milliseconds back_off() const;

  std::string endpoint_;
  WorkerLauncher* launcher_;
  SupervisorLimits limits_;
  std::string name_;
  std::vector<Worker> workers_;
  bool retired_ = false;
  std::uint64_t launched_n_ = 0;
  int failed_starts_n_ = 0;
  bool any_was_ready_ = false;
};

}  // namespace graspd::service
