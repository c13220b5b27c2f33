#include <unistd.h>

#include "front_impl.hpp"
#include "process_memory.hpp"

namespace graspd::service {
namespace {

using std::chrono::seconds;

// A loop that sleeps a second at most and has not turned for so long, hangs.
constexpr seconds kHung{10};
constexpr seconds kMemoryInterval{1};

}  // namespace

/// Every condition of readiness has its sentence here. That the catalogue is loaded is one of there
/// being a front, that the golden frame was planned one of a worker being ready.
std::optional<std::string> Front::Impl::why_not_ready() const {
  if (drain_until_) return "the server is shutting down; use another server";
  if (!authenticates_) {
    return "authentication does not answer, so that no client is let in; restart the server";
  }
  const Supervisor& workers = crew_->workers;
  if (!was_ready_) {
    return fmt::format("{} of {} workers are ready{}{}", workers.ready_n(),
                       workers.identities().size(), last_loss_.empty() ? "" : "; ", last_loss_);
  }
  if (workers.ready_n() == 0) {
    return fmt::format("no worker is up; {}; it is being replaced", last_loss_);
  }
  return std::nullopt;
}

std::optional<std::string> Front::Impl::why_not_alive() const {
  const auto silent = std::chrono::duration_cast<seconds>(Clock::now() - status_.published());
  if (silent < kHung) return std::nullopt;
  return fmt::format("the server has read no message for {} s; restart it", silent.count());
}

Phase Front::Impl::phase() const {
  if (drain_until_) return Phase::kDraining;
  if (!was_ready_) return Phase::kStarting;
  return reload_again_ || changing_parts() ? Phase::kReloading : Phase::kReady;
}

HttpPages Front::Impl::http_pages() {
  return {[this] { return metrics_.text(); }, [this] { return why_not_alive(); },
          [this] { return status_.why_not_ready(); }};
}

void Front::Impl::observe() {
  const TimePoint now = Clock::now();
  for (const std::string& notice : flight_recorder_.news()) log(LogLevel::kWarning, "{}", notice);
  if (now - memory_looked_at_ >= kMemoryInterval) {
    memory_looked_at_ = now;
    front_memory_bytes_ = resident_bytes(getpid());
    workers_memory_bytes_ = 0;
    for (const Crew* crew : crews()) {
      for (const int pid : crew->workers.pids()) workers_memory_bytes_ += resident_bytes(pid);
    }
  }
  const auto why_not = why_not_ready();
  Load load;
  load.queued_n = admission_.queued_n();
  load.workers_ready_n = crew_->workers.ready_n();
  load.workers_busy_n = crew_->workers.busy_n();
  load.front_memory_bytes = front_memory_bytes_;
  load.workers_memory_bytes = workers_memory_bytes_;
  load.ready = !why_not;
  load.draining = drain_until_.has_value();
  metrics_.set_load(load);
  status_.publish(now, why_not);
  if (options_.on_turn) options_.on_turn(phase());
}

HealthAnswer Front::Impl::health() const {
  HealthAnswer health;
  health.state = drain_until_ ? ServerState::kDraining
                              : (why_not_ready() ? ServerState::kStarting : ServerState::kReady);
  health.workers_n = static_cast<std::uint32_t>(crew_->workers.ready_n());
  health.workers_busy_n = static_cast<std::uint32_t>(crew_->workers.busy_n());
  health.queued_n = static_cast<std::uint32_t>(admission_.queued_n());
  health.answered_n = answered_n_;
  health.uptime_s = std::chrono::duration<double>(Clock::now() - started_).count();
  health.part_ids = crew_->facts.part_ids;
  health.server = crew_->facts.server;
  health.answers_by_code = metrics_.answers_by_code();
  health.stages = metrics_.stages();
  health.workers_lost_n = metrics_.workers_lost_n();
  health.memory_bytes = front_memory_bytes_ + workers_memory_bytes_;
  return health;
}

/// Metrics and the log's line of a request, at the moment of its one answer.
void Front::Impl::tell(Job& job, Code code, WorkReport report) {
  const TimePoint now = Clock::now();
  metrics_.answered(job.plan.cell, code, now - job.arrived);
  if (report.outcome) metrics_.planned(*report.outcome, job.plan.parts, report.timings);
  RequestEnd end;
  end.code = code;
  end.report = std::move(report);
  end.queued = (job.crew ? job.started : now) - job.arrived;
  end.taken = now - job.arrived;
  if (is_to_be_kept(job, code)) {
    job.flight = FlightRecorder::name_of(job.plan.id);
    end.recorded = flight_recorder_.path_of(job.plan.cell, job.flight);
  }
  const Crew& crew = job.crew ? *job.crew : *crew_;
  log_json(LogLevel::kInfo, log_line(job.plan, end, crew.facts.server));
}

/// Only what a worker was given can be computed again.
bool Front::Impl::is_to_be_kept(const Job& job, Code code) const {
  if (!flight_recorder_.is_on() || !job.crew || code == Code::kDraining) return false;
  const bool failed = code == Code::kInternal || code == Code::kDeadlineExceeded;
  const bool all = options_.config.flight_recorder.keep == FlightsKept::kAll;
  return failed || all || job.plan.record;
}

/// After the answer has left.
void Front::Impl::keep(Job& job, zmq::message_t answer) {
  if (job.flight.empty()) return;
  flight_recorder_.keep(std::move(job.flight), {job.plan.cell, job.plan.id, job.crew->facts.server,
                                                std::move(job.kept_envelope),
                                                std::move(job.kept_payload), std::move(answer)});
}

}  // namespace graspd::service
