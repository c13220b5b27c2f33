#include "cells.hpp"

#include <algorithm>

#include "graspd/types/flight.hpp"

namespace graspd::console {
namespace {

using nlohmann::json;

constexpr std::size_t kCyclesOfMedian_n = 50;

std::string to_line(const json& value) {
  return value.dump(-1, ' ', false, json::error_handler_t::replace);
}

template <class T>
json or_null(const std::optional<T>& value) {
  return value ? json(*value) : json();
}

double median(std::deque<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

/// A flight's name ends with the id of its request.
std::string request_id_of(const std::string& flight) {
  const std::size_t id = flight.rfind('_') + 1;
  return flight.substr(id, flight.size() - id - std::string_view(kFlightExtension).size());
}

json pick_json(const pick_records::PickLine& line) {
  json passed_over = json::array();
  for (const auto& [rank, reason] : line.passed_over) passed_over.push_back({rank, reason});
  json pick = {{"frame_n", line.frame_n},
               {"request_id", line.request_id},
               {"verdict", line.verdict},
               {"outcome", line.outcome},
               {"message", line.message},
               {"part", line.part},
               {"rank", line.rank},
               {"cycle_s", line.end_s - line.start_s},
               {"passed_over", std::move(passed_over)}};
  for (const auto& [step, ms] : line.steps_ms) {
    if (step == "plan") pick["plan_ms"] = ms;
  }
  return pick;
}

json plan_json(const PlanSeen& plan) {
  return {{"flight", plan.flight},
          {"stamp_s", plan.stamp_s},
          {"code", plan.code},
          {"outcome", plan.outcome},
          {"message", plan.message},
          {"objects_n", plan.objects_n},
          {"grasps_n", plan.grasps_n},
          {"server_ms", plan.server_ms},
          {"fill_level", or_null(plan.fill_level)}};
}

}  // namespace

Cells::Cell& Cells::touch(const std::string& name) {
  if (cells_.size() >= kMostCells_n && !cells_.contains(name)) {
    cells_.erase(std::ranges::min_element(
        cells_, {}, [](const auto& name_and_cell) { return name_and_cell.second.version; }));
  }
  Cell& cell = cells_[name];
  cell.version = ++version_;
  changed_.notify_all();
  return cell;
}

void Cells::add(PlanSeen plan) {
  const std::lock_guard lock(mutex_);
  std::deque<PlanSeen>& plans = touch(plan.cell).plans;
  const auto after = std::ranges::upper_bound(plans, plan.flight, {}, &PlanSeen::flight);
  const bool is_there = after != plans.begin() && std::prev(after)->flight == plan.flight;
  if (!is_there) plans.insert(after, std::move(plan));
  if (plans.size() > kMostPlans_n) plans.pop_front();
}

void Cells::begin_run(const std::string& cell) {
  const std::lock_guard lock(mutex_);
  Cell& known = touch(cell);
  known.cycles_s.clear();
  known.picks_n = known.placed_n = 0;
  known.alarm.clear();
}

void Cells::add(const std::string& cell, const pick_records::PickLine& line) {
  const std::lock_guard lock(mutex_);
  Cell& known = touch(cell);
  known.last_pick = pick_json(line);
  if (known.last_pick.contains("plan_ms")) known.round_trip_ms = known.last_pick["plan_ms"];
  known.picks.emplace_back(line.request_id, known.last_pick);
  if (known.picks.size() > kMostPlans_n) known.picks.pop_front();
  if (line.is_alarmed) known.alarm = line.message;
  if (!line.is_pick()) return;
  ++known.picks_n;
  if (line.verdict == "PLACED") ++known.placed_n;
  known.cycles_s.push_back(line.end_s - line.start_s);
  if (known.cycles_s.size() > kCyclesOfMedian_n) known.cycles_s.pop_front();
}

void Cells::set_run_state(const pick_records::Run& run) {
  const std::lock_guard lock(mutex_);
  Cell& known = touch(run.cell);
  known.run_state = run.state;
  known.run_reason = run.reason;
}

void Cells::set_servers(std::string json) {
  const std::lock_guard lock(mutex_);
  if (json == servers_) return;
  servers_ = std::move(json);
  servers_version_ = ++version_;
  changed_.notify_all();
}

void Cells::wake() {
  const std::lock_guard lock(mutex_);
  ++woken_n_;
  changed_.notify_all();
}

json Cells::summary(const std::string& name, const Cell& cell) {
  json all = {{"cell", name},
              {"run_state", cell.run_state},
              {"run_reason", cell.run_reason},
              {"alarm", cell.alarm},
              {"picks_n", cell.picks_n},
              {"placed_n", cell.placed_n},
              {"round_trip_ms", or_null(cell.round_trip_ms)},
              {"last_pick", cell.last_pick}};
  if (!cell.cycles_s.empty()) all["cycle_s"] = median(cell.cycles_s);
  if (!cell.plans.empty()) all["plan"] = plan_json(cell.plans.back());
  return all;
}

std::vector<Event> Cells::changes_since(std::uint64_t& seen, std::chrono::milliseconds patience) {
  std::unique_lock lock(mutex_);
  const std::uint64_t woken_n = woken_n_;
  changed_.wait_for(lock, patience, [&] { return version_ > seen || woken_n_ != woken_n; });
  std::vector<Event> events;
  if (servers_version_ > seen) events.push_back({"servers", servers_});
  for (const auto& [name, cell] : cells_) {
    if (cell.version > seen) events.push_back({"cell", to_line(summary(name, cell))});
  }
  seen = version_;
  return events;
}

std::string Cells::history(const std::string& cell) const {
  const std::lock_guard lock(mutex_);
  json lines = json::array();
  const auto found = cells_.find(cell);
  if (found == cells_.end()) return to_line(lines);
  const auto& picks = found->second.picks;
  for (const PlanSeen& plan : found->second.plans) {
    json line = plan_json(plan);
    const auto pick = std::ranges::find(picks, request_id_of(plan.flight),
                                        [](const auto& id_and_pick) { return id_and_pick.first; });
    if (pick != picks.end()) line["pick"] = pick->second;
    lines.push_back(std::move(line));
  }
  return to_line(lines);
}

}  // namespace graspd::console
