#include "graspd/service/supervisor.hpp"

#include <algorithm>
#include <stdexcept>

namespace graspd::service {

using std::chrono::milliseconds;

Supervisor::Supervisor(std::size_t workers_n, std::string endpoint, WorkerLauncher& launcher,
                       SupervisorLimits limits, std::string name)
    : endpoint_(std::move(endpoint)),
      launcher_(&launcher),
      limits_(limits),
      name_(std::move(name)),
      workers_(workers_n) {}

Supervisor::Report Supervisor::tend(TimePoint now) {
  Report report;
  for (std::size_t slot = 0; slot < workers_.size(); ++slot) {
    Worker& worker = workers_[slot];
    if (worker.handle) {
      if (const auto reason = worker.handle->exit_reason()) bury(worker, *reason, now, report);
    }
    if (worker.handle) check_limits(worker, now);
    const bool due = worker.state == State::kAbsent && worker.since <= now;
    if (due && !retired_) launch(worker, slot, now);
  }
  return report;
}

TimePoint Supervisor::next_tend() const {
  TimePoint next = TimePoint::max();
  for (const Worker& worker : workers_) {
    switch (worker.state) {
      case State::kAbsent:
        if (!retired_) next = std::min(next, worker.since);
        break;
      case State::kStarting:
        next = std::min(next, worker.since + limits_.start);
        break;
      case State::kIdle:
      case State::kLeaving:
        next = std::min(next, worker.last_heard + limits_.silence);
        break;
      case State::kBusy:
        next = std::min(next, worker.since + limits_.job);
        break;
      case State::kDoomed:
        break;  // its exit_fd will tell
    }
  }
  return next;
}

std::vector<int> Supervisor::exit_fds() const {
  std::vector<int> fds;
  for (const Worker& worker : workers_) {
    if (worker.handle) fds.push_back(worker.handle->exit_fd());
  }
  return fds;
}

std::vector<int> Supervisor::pids() const {
  std::vector<int> pids;
  for (const Worker& worker : workers_) {
    if (worker.handle && worker.handle->pid() != 0) pids.push_back(worker.handle->pid());
  }
  return pids;
}

bool Supervisor::heard(const std::string& identity, TimePoint now) {
  Worker* worker = find(identity);
  if (worker == nullptr || worker->state == State::kDoomed) return false;
  worker->last_heard = now;
  return true;
}

void Supervisor::ready(const std::string& identity) {
  Worker* worker = find(identity);
  if (worker == nullptr || worker->state != State::kStarting) return;
  worker->state = State::kIdle;
  worker->since = worker->last_heard;
  worker->was_ready = true;
  any_was_ready_ = true;
  failed_starts_n_ = 0;
}

void Supervisor::reject(const std::string& identity, const std::string& reason) {
  if (Worker* worker = find(identity)) doom(*worker, reason);
}

void Supervisor::dismiss(const std::string& identity, TimePoint now) {
  Worker* worker = find(identity);
  if (worker == nullptr || worker->state != State::kIdle) return;
  worker->state = State::kLeaving;
  worker->last_heard = now;
}

std::optional<std::string> Supervisor::idle() const {
  const Worker* longest = nullptr;
  for (const Worker& worker : workers_) {
    if (worker.state != State::kIdle) continue;
    if (longest == nullptr || worker.since < longest->since) longest = &worker;
  }
  return longest ? std::optional(longest->identity) : std::nullopt;
}

void Supervisor::assign(const std::string& identity, Ticket ticket, TimePoint now) {
  Worker* worker = find(identity);
  if (worker == nullptr || worker->state != State::kIdle) {
    throw std::logic_error("Supervisor: " + identity + " is not idle");
  }
  worker->state = State::kBusy;
  worker->since = now;
  worker->ticket = ticket;
  worker->holds_ticket = true;
}

std::optional<Ticket> Supervisor::release(const std::string& identity, TimePoint now) {
  Worker* worker = find(identity);
  if (worker == nullptr || worker->state != State::kBusy) return std::nullopt;
  worker->state = State::kIdle;
  worker->since = now;
  worker->holds_ticket = false;
  return worker->ticket;
}

std::vector<std::string> Supervisor::identities() const {
  std::vector<std::string> identities;
  for (const Worker& worker : workers_) {
    if (worker.handle) identities.push_back(worker.identity);
  }
  return identities;
}

std::size_t Supervisor::ready_n() const {
  return static_cast<std::size_t>(
      std::count_if(workers_.begin(), workers_.end(), [](const Worker& worker) {
        return worker.state == State::kIdle || worker.state == State::kBusy;
      }));
}

std::size_t Supervisor::busy_n() const {
  return static_cast<std::size_t>(std::count_if(
      workers_.begin(), workers_.end(), [](const Worker& w) { return w.state == State::kBusy; }));
}

Supervisor::Worker* Supervisor::find(const std::string& identity) {
  const auto found = std::find_if(workers_.begin(), workers_.end(), [&](const Worker& worker) {
    return worker.handle && worker.identity == identity;
  });
  return found == workers_.end() ? nullptr : &*found;
}

void Supervisor::launch(Worker& worker, std::size_t slot, TimePoint now) {
  // A new name each time: a message that its predecessor left in the socket is not taken for its.
  worker = {};
  worker.identity = fmt::format("{}-{}.{}", name_, slot, ++launched_n_);
  worker.handle = launcher_->launch(endpoint_, worker.identity);
  worker.state = State::kStarting;
  worker.since = now;
  worker.last_heard = now;
}

void Supervisor::bury(Worker& worker, const std::string& reason, TimePoint now, Report& report) {
  const std::string why = worker.doom.empty() ? reason : worker.doom;
  if (worker.state != State::kLeaving) {
    report.notices.push_back(
        fmt::format("{} ({}) is gone: {}", worker.identity, worker.handle->name(), why));
  }
  if (worker.holds_ticket) report.lost.push_back({worker.ticket, why});
  const bool has_failed = !worker.was_ready;
  if (has_failed) ++failed_starts_n_;
  worker = {};
  worker.since = now + (has_failed ? back_off() : milliseconds(0));
  if (has_failed && !any_was_ready_ && failed_starts_n_ >= limits_.failed_starts_n) {
    throw std::runtime_error(
        fmt::format("workers end before they are ready; the last one: {}", why));
  }
}

void Supervisor::check_limits(Worker& worker, TimePoint now) {
  if (worker.state == State::kStarting && now - worker.since >= limits_.start) {
    doom(worker, fmt::format("it was not ready within {} ms", limits_.start.count()));
  } else if ((worker.state == State::kIdle || worker.state == State::kLeaving) &&
             now - worker.last_heard >= limits_.silence) {
    doom(worker, fmt::format("no sign of life for {} ms", limits_.silence.count()));
  } else if (worker.state == State::kBusy && now - worker.since >= limits_.job) {
    doom(worker,
         fmt::format("it computed longer than worker_time_limit_ms = {} ms", limits_.job.count()));
  }
}

void Supervisor::doom(Worker& worker, std::string reason) {
  worker.state = State::kDoomed;
  worker.doom = std::move(reason);
  worker.handle->kill();
}

milliseconds Supervisor::back_off() const {
  const int doublings = std::min(failed_starts_n_ - 1, 16);
  return std::min(limits_.last_back_off, limits_.first_back_off * (1 << std::max(doublings, 0)));
}

}  // namespace graspd::service
