#include "graspd/load/summary.hpp"

#include <algorithm>
#include <cmath>

namespace graspd::load {
namespace {

constexpr double kLate_ms = 10;

/// The value that this share of all is not above.
double at_share(const std::vector<double>& sorted, double share) {
  const auto rank = static_cast<std::size_t>(std::ceil(share * static_cast<double>(sorted.size())));
  return sorted[std::max<std::size_t>(rank, 1) - 1];
}

double ms(std::int64_t time_ns) { return static_cast<double>(time_ns) / 1e6; }

/// Means of where the time of OK requests went, in the order it goes.
std::vector<std::pair<std::string, double>> split_of(const std::vector<const Sample*>& samples) {
  std::vector<std::pair<std::string, double>> split{{"send", 0}, {"transport", 0}};
  std::size_t ok_n = 0;
  for (const Sample* sample : samples) {
    if (sample->code != Code::kOk) continue;
    ++ok_n;
    const double sent_ms = sample->sent_ms.value_or(0);
    double transport_ms = sample->ended_ms - sent_ms;
    for (const auto& [stage, duration_ns] : sample->timings) {
      transport_ms -= ms(duration_ns);
      auto part = std::find_if(split.begin(), split.end(),
                               [&](const auto& known) { return known.first == stage; });
      if (part == split.end()) part = split.insert(split.end(), {stage, 0});
      part->second += ms(duration_ns);
    }
    split[0].second += sent_ms;
    split[1].second += transport_ms;
  }
  for (auto& [name, sum_ms] : split) sum_ms /= static_cast<double>(std::max<std::size_t>(ok_n, 1));
  return split;
}

}  // namespace

Quantiles quantiles_of(std::vector<double> values) {
  if (values.empty()) return {};
  std::sort(values.begin(), values.end());
  return {at_share(values, 0.5), at_share(values, 0.9), at_share(values, 0.99),
          at_share(values, 0.999), values.back()};
}

double jain(const std::vector<double>& shares) {
  double sum = 0;
  double squares = 0;
  for (const double share : shares) {
    sum += share;
    squares += share * share;
  }
  return squares > 0 ? sum * sum / (static_cast<double>(shares.size()) * squares) : 1;
}

Summary summarise(const std::vector<Sample>& samples, double begin_s, double end_s,
                  std::size_t cells_n) {
  const auto is_in = [&](double time_s) { return begin_s <= time_s && time_s < end_s; };
  Summary summary;
  summary.length_s = end_s - begin_s;
  summary.cells.resize(cells_n);
  std::vector<const Sample*> planned;
  std::vector<double> latency_ms;
  std::vector<double> clock_error_ms;
  std::vector<double> sent_ms;
  std::vector<std::vector<double>> cells_ms(cells_n);
  for (const Sample& sample : samples) {
    const bool is_ok = sample.code == Code::kOk;
    const double per_s = 1 / summary.length_s;
    if (is_ok && is_in(sample.planned_s + sample.ended_ms / 1e3)) {
      summary.goodput_hz += per_s;
      summary.cells[sample.cell].goodput_hz += per_s;
    }
    if (sample.sent_ms && is_in(sample.planned_s + *sample.sent_ms / 1e3)) summary.sent_hz += per_s;
    if (!is_in(sample.planned_s)) continue;
    planned.push_back(&sample);
    ++summary.ended_n[sample.code];
    ++summary.cells[sample.cell].asked_n;
    clock_error_ms.push_back(sample.handed_over_ms);
    if (sample.sent_ms) sent_ms.push_back(*sample.sent_ms);
    if (!is_ok) continue;
    latency_ms.push_back(sample.ended_ms);
    cells_ms[sample.cell].push_back(sample.ended_ms);
  }
  std::vector<double> goodputs_hz;
  for (std::size_t cell = 0; cell < cells_n; ++cell) {
    CellSummary& own = summary.cells[cell];
    own.ok_n = cells_ms[cell].size();
    own.latency_ms = quantiles_of(std::move(cells_ms[cell]));
    goodputs_hz.push_back(own.goodput_hz);
  }
  summary.asked_n = planned.size();
  summary.ok_n = latency_ms.size();
  summary.asked_hz = static_cast<double>(summary.asked_n) / summary.length_s;
  summary.latency_ms = quantiles_of(std::move(latency_ms));
  summary.clock_error_ms = quantiles_of(std::move(clock_error_ms));
  summary.sent_ms = quantiles_of(std::move(sent_ms));
  summary.split_ms = split_of(planned);
  summary.jain = jain(goodputs_hz);
  return summary;
}

bool is_late(const Summary& summary) { return summary.clock_error_ms.p50 > kLate_ms; }

}  // namespace graspd::load
