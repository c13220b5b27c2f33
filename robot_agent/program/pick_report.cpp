#include "pick_report.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>

#include "graspd/formats/table.hpp"

namespace graspd::robot_agent {
namespace {

using pick_records::PickLine;
using pick_records::Run;

constexpr double kMillisecondsPerSecond = 1e3;
constexpr double kSecondsPerHour = 3600;

std::string percent(double part, double whole) {
  return whole > 0 ? fmt::format("{:.1f} %", 100 * part / whole) : "-";
}

/// Where the true rate lies with 95 % confidence, after Wilson.
std::string confidence(double successes_n, double trials_n) {
  if (trials_n == 0) return "-";
  constexpr double z = 1.96;
  const double rate = successes_n / trials_n;
  const double scale = 1 / (1 + z * z / trials_n);
  const double centre = scale * (rate + z * z / (2 * trials_n));
  const double half =
      scale * z * std::sqrt(rate * (1 - rate) / trials_n + z * z / (4 * trials_n * trials_n));
  return fmt::format("{:.1f} to {:.1f} %", 100 * std::max(0.0, centre - half),
                     100 * std::min(1.0, centre + half));
}

double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  if (values.size() % 2 == 1) return *middle;
  return (*middle + *std::max_element(values.begin(), middle)) / 2;
}

std::vector<const PickLine*> all_lines(const std::vector<Run>& runs) {
  std::vector<const PickLine*> lines;
  for (const Run& run : runs) {
    for (const PickLine& line : run.picks) lines.push_back(&line);
  }
  return lines;
}

std::size_t count(const std::vector<const PickLine*>& lines, auto is_counted) {
  return static_cast<std::size_t>(
      std::ranges::count_if(lines, [&](const PickLine* line) { return is_counted(*line); }));
}
bool is_pick(const PickLine& line) { return line.is_pick(); }
bool is_placed(const PickLine& line) { return line.verdict == "PLACED"; }

/// What a count of texts looks like, the most frequent first.
Table counts(std::vector<std::string> header, const std::map<std::string, std::size_t>& by_text) {
  std::vector<std::pair<std::string, std::size_t>> sorted(by_text.begin(), by_text.end());
  std::ranges::stable_sort(sorted, std::greater(), &std::pair<std::string, std::size_t>::second);
  Table table(std::move(header));
  for (const auto& [text, n] : sorted) table.add({text, std::to_string(n)});
  return table;
}

Table table_of_runs(const std::vector<Run>& runs) {
  Table table({"run", "cell", "frames", "picks", "placed", "ended"});
  for (const Run& run : runs) {
    table.add({run.folder.filename().string(), run.cell, std::to_string(run.picks.size()),
               std::to_string(std::ranges::count_if(run.picks, is_pick)),
               std::to_string(std::ranges::count_if(run.picks, is_placed)),
               run.reason.empty() ? run.state : fmt::format("{}: {}", run.state, run.reason)});
  }
  return table;
}

Table table_of_results(const std::vector<Run>& runs) {
  const auto lines = all_lines(runs);
  const std::size_t picks_n = count(lines, is_pick);
  const std::size_t placed_n = count(lines, is_placed);
  double span_s = 0;
  for (const Run& run : runs) {
    if (!run.picks.empty()) span_s += run.picks.back().end_s - run.picks.front().start_s;
  }
  std::vector<double> cycles_s;
  double cycle_s = 0;
  double plan_s = 0;
  for (const PickLine* line : lines) {
    if (!line->is_pick()) continue;
    cycles_s.push_back(line->end_s - line->start_s);
    cycle_s += cycles_s.back();
    for (const auto& [step, ms] : line->steps_ms) {
      if (step == "plan") plan_s += ms / kMillisecondsPerSecond;
    }
  }
  Table table({"", "value"});
  table.add({"picks", std::to_string(picks_n)});
  table.add({"placed", std::to_string(placed_n)});
  table.add({"success", percent(double(placed_n), double(picks_n))});
  table.add({"… with 95 % confidence", confidence(double(placed_n), double(picks_n))});
  table.add(
      {"picks per hour",
       span_s > 0 ? fmt::format("{:.0f}", double(placed_n) / span_s * kSecondsPerHour) : "-"});
  table.add({"cycle, median",
             cycles_s.empty() ? "-" : fmt::format("{:.2f} s", median(std::move(cycles_s)))});
  table.add({"planning, of the cycle", percent(plan_s, cycle_s)});
  table.add({"drift alarms",
             std::to_string(count(lines, [](const PickLine& line) { return line.is_alarmed; }))});
  return table;
}

Table table_of_parts(const std::vector<const PickLine*>& lines) {
  std::map<std::string, std::vector<const PickLine*>> by_part;
  for (const PickLine* line : lines) {
    if (line->is_pick()) by_part[line->part].push_back(line);
  }
  Table table({"part", "picks", "placed", "missed", "dropped", "fault", "success"});
  for (const auto& [part, picks] : by_part) {
    const auto with = [&picks = picks](std::string_view verdict) {
      return count(picks, [&](const PickLine& line) { return line.verdict == verdict; });
    };
    table.add({part, std::to_string(picks.size()), std::to_string(with("PLACED")),
               std::to_string(with("MISSED")), std::to_string(with("DROPPED")),
               std::to_string(with("FAULT")),
               percent(double(with("PLACED")), double(picks.size()))});
  }
  return table;
}

/// Every frame that put no part in its place.
Table table_of_failures(const std::vector<const PickLine*>& lines) {
  std::map<std::string, std::size_t> by_reason;
  for (const PickLine* line : lines) {
    if (is_placed(*line)) continue;
    const std::string& what = line->is_pick()         ? line->verdict
                              : line->outcome.empty() ? line->code
                                                      : line->outcome;
    ++by_reason[fmt::format("{}: {}", what, line->message)];
  }
  return counts({"failure", "times"}, by_reason);
}

Table table_of_steps(const std::vector<const PickLine*>& lines) {
  std::vector<std::pair<std::string, std::vector<double>>> by_step;  // in the order of the cycle
  double cycles_ms = 0;
  for (const PickLine* line : lines) {
    if (!is_placed(*line)) continue;
    cycles_ms += (line->end_s - line->start_s) * kMillisecondsPerSecond;
    std::map<std::string, double> of_pick;  // a pick checks its gripper more than once
    for (const auto& [step, ms] : line->steps_ms) of_pick[step] += ms;
    for (const auto& [step, ms] : line->steps_ms) {
      auto known = std::ranges::find(by_step, step, &decltype(by_step)::value_type::first);
      if (known == by_step.end()) known = by_step.insert(known, {step, {}});
      if (const auto sum = of_pick.extract(step)) known->second.push_back(sum.mapped());
    }
  }
  Table table({"step of a placed part", "median ms", "of the cycle"});
  double steps_ms = 0;
  for (const auto& [step, ms] : by_step) {
    const double total_ms = std::reduce(ms.begin(), ms.end());
    table.add({step, fmt::format("{:.1f}", median(ms)), percent(total_ms, cycles_ms)});
    steps_ms += total_ms;
  }
  if (!by_step.empty()) table.add({"rest", "-", percent(cycles_ms - steps_ms, cycles_ms)});
  return table;
}

Table table_of_passed_over(const std::vector<const PickLine*>& lines) {
  std::map<std::string, std::size_t> by_reason;
  for (const PickLine* line : lines) {
    for (const auto& over : line->passed_over) ++by_reason[over.reason];
  }
  return counts({"grasp passed over because", "times"}, by_reason);
}

}  // namespace

std::string pick_report(const std::vector<Run>& runs, bool markdown) {
  const auto lines = all_lines(runs);
  const Table tables[] = {table_of_runs(runs),   table_of_results(runs),
                          table_of_parts(lines), table_of_failures(lines),
                          table_of_steps(lines), table_of_passed_over(lines)};
  std::string text;
  for (const Table& table : tables) {
    if (table.is_empty()) continue;
    if (!text.empty()) text += '\n';
    text += markdown ? table.to_markdown() : table.to_text();
  }
  return text;
}

}  // namespace graspd::robot_agent
