#include "graspd/service/metrics.hpp"

#include <prometheus/counter.h>
#include <prometheus/gauge.h>
#include <prometheus/histogram.h>
#include <prometheus/registry.h>
#include <prometheus/text_serializer.h>

#include <algorithm>
#include <map>
#include <mutex>

namespace graspd::service {
namespace {

using prometheus::Counter;
using prometheus::Family;
using prometheus::Gauge;
using prometheus::Histogram;

constexpr std::string_view kOtherCell = "other";

const Histogram::BucketBoundaries kSeconds{0.001, 0.002, 0.005, 0.01, 0.02, 0.05, 0.1,
                                           0.2,   0.5,   1,     2,    5,    10,   30};

double in_seconds(std::chrono::nanoseconds duration) {
  return std::chrono::duration<double>(duration).count();
}

}  // namespace

class Metrics::Impl {
 public:
  Impl();

  struct OfCell {
    std::map<Code, Counter*> answers;
  };
  struct OfStage {
    Histogram* histogram;
    StageTotal total;
  };
  OfCell make_cell(const std::string& name);
  OfCell& cell(std::string_view name);
  OfStage& stage(const std::string& name);

  prometheus::Registry registry;
  Family<Counter>& answers = counters("graspd_answers_total", "Answers, by cell and code.");
  Family<Counter>& shed =
      counters("graspd_shed_total",
               "Answers BUSY, SUPERSEDED, DEADLINE_EXCEEDED or DRAINING: too much load.");
  Family<Counter>& broken =
      counters("graspd_broken_total", "Answers INTERNAL or REJECTED_POISON: defects.");
  Family<Counter>& outcomes = counters("graspd_outcomes_total", "Plans, by their outcome.");
  Family<Counter>& parts = counters("graspd_planned_parts_total", "Plans that asked for a part.");
  Family<Counter>& auth_failures =
      counters("graspd_auth_failures_total", "Connections and messages not let in, by the reason.");
  Counter& workers_lost =
      counters("graspd_workers_lost_total", "Workers that ended and were replaced.").Add({});
  Histogram& answer_seconds =
      histograms("graspd_answer_seconds", "From a request's arrival to its answer.")
          .Add({}, kSeconds);
  Family<Histogram>& stage_seconds =
      histograms("graspd_stage_seconds", "Time that plans took, by stage.");
  Family<Gauge>& workers = gauges("graspd_workers", "Workers that are ready, and those at work.");
  Gauge& workers_ready = workers.Add({{"state", "ready"}});
  Gauge& workers_busy = workers.Add({{"state", "busy"}});
  Family<Gauge>& memory = gauges("graspd_memory_bytes", "Resident memory of front and workers.");
  Gauge& front_memory = memory.Add({{"process", "front"}});
  Gauge& workers_memory = memory.Add({{"process", "workers"}});
  Gauge& queued = gauges("graspd_queued_requests", "Requests that wait for a worker.").Add({});
  Gauge& ready = gauges("graspd_ready", "1 where /readyz says so.").Add({});
  Gauge& draining = gauges("graspd_draining", "1 where the server is shutting down.").Add({});
  Family<Gauge>& build_info =
      gauges("graspd_build_info", "1; what answers depend on beside the request.");

  /// Of what follows: prometheus-cpp guards its own.
  std::mutex mutex;
  Gauge* build = nullptr;
  std::map<std::string, OfCell, std::less<>> by_cell;
  std::vector<OfStage> by_stage;  ///< in the order they are run in
  std::map<Code, std::uint64_t> by_code;

 private:
  Family<Counter>& counters(const char* name, const char* help) {
    return prometheus::BuildCounter().Name(name).Help(help).Register(registry);
  }
  Family<Gauge>& gauges(const char* name, const char* help) {
    return prometheus::BuildGauge().Name(name).Help(help).Register(registry);
  }
  Family<Histogram>& histograms(const char* name, const char* help) {
    return prometheus::BuildHistogram().Name(name).Help(help).Register(registry);
  }
};

// Series are there from the start, with 0: a rate must see the first of them.
Metrics::Impl::Impl() {
  by_cell.emplace(kOtherCell, make_cell(std::string(kOtherCell)));
  for (const auto& [outcome, name] : EnumNames<Outcome>::values) {
    outcomes.Add({{"outcome", std::string(name)}});
  }
  for (const auto& [code, name] : EnumNames<Code>::values) {
    if (is_shed(code)) shed.Add({{"code", std::string(name)}});
    if (is_broken(code)) broken.Add({{"code", std::string(name)}});
  }
  for (const auto& [why, name] : EnumNames<AuthFailure>::values) {
    auth_failures.Add({{"reason", std::string(name)}});
  }
}

Metrics::Impl::OfCell Metrics::Impl::make_cell(const std::string& name) {
  OfCell made;
  for (const auto& [code, code_name] : EnumNames<Code>::values) {
    if (code == Code::kUnavailable) continue;  // never answered
    made.answers[code] = &answers.Add({{"cell", name}, {"code", std::string(code_name)}});
  }
  return made;
}

Metrics::Impl::OfCell& Metrics::Impl::cell(std::string_view name) {
  const auto found = by_cell.find(name);
  return found == by_cell.end() ? by_cell.find(kOtherCell)->second : found->second;
}

Metrics::Impl::OfStage& Metrics::Impl::stage(const std::string& name) {
  const auto found = std::find_if(by_stage.begin(), by_stage.end(),
                                  [&](const OfStage& known) { return known.total.stage == name; });
  if (found != by_stage.end()) return *found;
  return by_stage.emplace_back(
      OfStage{&stage_seconds.Add({{"stage", name}}, kSeconds), {name, 0, 0}});
}

Metrics::Metrics(const ServerInfo& server, const std::vector<std::string>& part_ids)
    : impl_(std::make_unique<Impl>()) {
  serve(server, part_ids);
}
Metrics::~Metrics() = default;

void Metrics::serve(const ServerInfo& server, const std::vector<std::string>& part_ids) {
  const std::lock_guard lock(impl_->mutex);
  if (impl_->build != nullptr) impl_->build_info.Remove(impl_->build);
  impl_->build = &impl_->build_info.Add({{"build", server.build},
                                         {"catalogue_hash", server.catalogue_hash},
                                         {"config_hash", server.config_hash}});
  impl_->build->Set(1);
  for (const std::string& id : part_ids) impl_->parts.Add({{"part", id}});
}

void Metrics::know(const std::string& cell) {
  const std::lock_guard lock(impl_->mutex);
  impl_->by_cell.emplace(cell, impl_->make_cell(cell));
}

void Metrics::answered(std::string_view cell, Code code, std::chrono::nanoseconds taken) {
  const std::lock_guard lock(impl_->mutex);
  impl_->cell(cell).answers.at(code)->Increment();
  ++impl_->by_code[code];
  const prometheus::Labels label{{"code", std::string(name_of(code))}};
  if (is_shed(code)) impl_->shed.Add(label).Increment();
  if (is_broken(code)) impl_->broken.Add(label).Increment();
  impl_->answer_seconds.Observe(in_seconds(taken));
}

void Metrics::planned(Outcome outcome, const std::vector<std::string>& part_ids,
                      const std::vector<StageTiming>& timings) {
  const std::lock_guard lock(impl_->mutex);
  impl_->outcomes.Add({{"outcome", std::string(name_of(outcome))}}).Increment();
  for (const std::string& id : part_ids) impl_->parts.Add({{"part", id}}).Increment();
  for (const StageTiming& timing : timings) {
    Impl::OfStage& stage = impl_->stage(timing.stage);
    stage.histogram->Observe(in_seconds(std::chrono::nanoseconds(timing.duration_ns)));
    ++stage.total.runs_n;
    stage.total.total_ns += timing.duration_ns;
  }
}

void Metrics::worker_lost() { impl_->workers_lost.Increment(); }

void Metrics::auth_failed(AuthFailure why, std::size_t times_n) {
  impl_->auth_failures.Add({{"reason", std::string(name_of(why))}})
      .Increment(static_cast<double>(times_n));
}

void Metrics::set_load(const Load& load) {
  impl_->workers_ready.Set(static_cast<double>(load.workers_ready_n));
  impl_->workers_busy.Set(static_cast<double>(load.workers_busy_n));
  impl_->front_memory.Set(static_cast<double>(load.front_memory_bytes));
  impl_->workers_memory.Set(static_cast<double>(load.workers_memory_bytes));
  impl_->queued.Set(static_cast<double>(load.queued_n));
  impl_->ready.Set(load.ready ? 1 : 0);
  impl_->draining.Set(load.draining ? 1 : 0);
}

std::string Metrics::text() const {
  return prometheus::TextSerializer().Serialize(impl_->registry.Collect());
}

std::vector<CodeCount> Metrics::answers_by_code() const {
  const std::lock_guard lock(impl_->mutex);
  std::vector<CodeCount> counts;
  for (const auto& [code, answers_n] : impl_->by_code) counts.push_back({code, answers_n});
  return counts;
}

std::vector<StageTotal> Metrics::stages() const {
  const std::lock_guard lock(impl_->mutex);
  std::vector<StageTotal> totals;
  for (const Impl::OfStage& stage : impl_->by_stage) totals.push_back(stage.total);
  return totals;
}

std::uint64_t Metrics::workers_lost_n() const {
  return static_cast<std::uint64_t>(impl_->workers_lost.Value());
}

}  // namespace graspd::service
