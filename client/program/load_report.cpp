#include "load_report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <nlohmann/json.hpp>

#include "graspd/formats/table.hpp"

namespace graspd::program {
namespace {

using Json = nlohmann::ordered_json;
using load::Quantiles;
using load::Run;
using load::Sample;
using load::Summary;

// The search is exact to 2 %.
constexpr double kAbove = 1.05;

std::string rate_name(const Run& run) {
  if (run.rate_hz > 0) return fmt::format("{:.1f}", run.rate_hz);
  return run.is_open ? "as recorded" : "closed loop";
}

std::string quantiles_line(const Quantiles& ms) {
  return fmt::format("p50 {:.2f}, p90 {:.2f}, p99 {:.2f}, p99.9 {:.2f}, worst {:.2f} ms", ms.p50,
                     ms.p90, ms.p99, ms.p999, ms.most);
}

std::string ended_line(const Summary& seen) {
  std::string line;
  for (const auto& [code, count] : seen.ended_n) {
    line += fmt::format("{}{} {}", line.empty() ? "" : ", ", name_of(code), count);
  }
  return line.empty() ? "nothing was asked" : line;
}

std::string split_line(const Summary& seen) {
  std::string line;
  for (const auto& [part, mean_ms] : seen.split_ms) {
    line += fmt::format("{}{} {:.2f}", line.empty() ? "" : ", ", part, mean_ms);
  }
  return line;
}

std::string cells_table(const LoadResult& result, const Summary& seen) {
  Table table({"cell", "asked", "OK", "OK/s", "p50 ms", "p99 ms"});
  for (std::size_t i = 0; i < seen.cells.size(); ++i) {
    const load::CellSummary& cell = seen.cells[i];
    table.add({result.cells[i], std::to_string(cell.asked_n), std::to_string(cell.ok_n),
               fmt::format("{:.2f}", cell.goodput_hz), fmt::format("{:.1f}", cell.latency_ms.p50),
               fmt::format("{:.1f}", cell.latency_ms.p99)});
  }
  return table.to_text();
}

std::string one_run(const LoadResult& result) {
  const Run& run = result.runs.front();
  const Summary& seen = run.summary;
  return cells_table(result, seen) +
         fmt::format(
             "\nasked     {:.1f}/s, sent {:.1f}/s; {} requests in {:.0f} s, {}\n"
             "clock     error {}\n"
             "ended     {}\n"
             "goodput   {:.2f}/s, fairness between cells (Jain) {:.4f}\n"
             "latency   {}\n"
             "of which  mean ms: {}\n"
             "this tool took {:.1f} % of a core\n",
             seen.asked_hz, seen.sent_hz, seen.asked_n, seen.length_s,
             run.is_stable ? "stable" : "not stable", quantiles_line(seen.clock_error_ms),
             ended_line(seen), seen.goodput_hz, seen.jain, quantiles_line(seen.latency_ms),
             split_line(seen), run.cpu_share * 100);
}

std::string many_runs(const LoadResult& result) {
  Table table({"asked/s", "OK/s", "OK %", "p50 ms", "p90 ms", "p99 ms", "p99.9 ms", "worst ms",
               "Jain", "clock p99 ms", "tool % of a core", "stable"});
  for (const Run& run : result.runs) {
    const Summary& seen = run.summary;
    const auto ms = [](double value) { return fmt::format("{:.1f}", value); };
    const double ok_share = static_cast<double>(seen.ok_n) /
                            static_cast<double>(std::max<std::size_t>(seen.asked_n, 1));
    table.add({rate_name(run), fmt::format("{:.2f}", seen.goodput_hz),
               fmt::format("{:.1f}", ok_share * 100), ms(seen.latency_ms.p50),
               ms(seen.latency_ms.p90), ms(seen.latency_ms.p99), ms(seen.latency_ms.p999),
               ms(seen.latency_ms.most), fmt::format("{:.4f}", seen.jain),
               fmt::format("{:.3f}", seen.clock_error_ms.p99),
               fmt::format("{:.1f}", run.cpu_share * 100), run.is_stable ? "yes" : "no"});
  }
  return table.to_text();
}

Json to_json(const Quantiles& ms) {
  return {{"p50", ms.p50}, {"p90", ms.p90}, {"p99", ms.p99}, {"p999", ms.p999}, {"most", ms.most}};
}

Json to_json(const Run& run, const std::vector<std::string>& names) {
  const Summary& seen = run.summary;
  Json json{{"is_open", run.is_open},
            {"rate_fps", run.rate_hz > 0 ? Json(run.rate_hz) : Json(nullptr)},
            {"is_stable", run.is_stable},
            {"length_s", seen.length_s},
            {"asked_n", seen.asked_n},
            {"ok_n", seen.ok_n},
            {"asked_fps", seen.asked_hz},
            {"sent_fps", seen.sent_hz},
            {"goodput_fps", seen.goodput_hz},
            {"jain", seen.jain},
            {"tool_cpu_share", run.cpu_share},
            {"latency_ms", to_json(seen.latency_ms)},
            {"clock_error_ms", to_json(seen.clock_error_ms)},
            {"sent_ms", to_json(seen.sent_ms)}};
  for (const auto& [code, count] : seen.ended_n) json["ended"][std::string(name_of(code))] = count;
  for (const auto& [part, mean_ms] : seen.split_ms) json["mean_ms"][part] = mean_ms;
  for (std::size_t i = 0; i < seen.cells.size(); ++i) {
    const load::CellSummary& cell = seen.cells[i];
    json["cells"].push_back({{"cell", names[i]},
                             {"asked_n", cell.asked_n},
                             {"ok_n", cell.ok_n},
                             {"goodput_fps", cell.goodput_hz},
                             {"latency_ms", to_json(cell.latency_ms)}});
  }
  for (const Summary& window : run.windows) {
    json["windows"].push_back({{"goodput_fps", window.goodput_hz},
                               {"p50_ms", window.latency_ms.p50},
                               {"p99_ms", window.latency_ms.p99},
                               {"ended", ended_line(window)}});
  }
  return json;
}

/// Every stage that any answer names, in the order they are run in.
std::vector<std::string> stages_of(const std::vector<Run>& runs) {
  std::vector<std::string> stages;
  for (const Run& run : runs) {
    for (const Sample& sample : run.samples) {
      for (const StageTiming& timing : sample.timings) {
        if (std::find(stages.begin(), stages.end(), timing.stage) == stages.end()) {
          stages.push_back(timing.stage);
        }
      }
    }
  }
  return stages;
}

void write_requests(std::ostream& csv, const LoadResult& result) {
  const std::vector<std::string> stages = stages_of(result.runs);
  csv << "rate_fps,planned_s,cell,code,handed_over_ms,sent_ms,ended_ms";
  for (const std::string& stage : stages) csv << "," << stage << "_ms";
  csv << "\n";
  for (const Run& run : result.runs) {
    for (const Sample& sample : run.samples) {
      csv << fmt::format(
          "{},{:.6f},{},{},{:.4f},{},{:.4f}",
          run.rate_hz > 0 ? fmt::format("{:.4f}", run.rate_hz) : "", sample.planned_s,
          result.cells[sample.cell], name_of(sample.code), sample.handed_over_ms,
          sample.sent_ms ? fmt::format("{:.4f}", *sample.sent_ms) : "", sample.ended_ms);
      for (const std::string& stage : stages) {
        const auto found =
            std::find_if(sample.timings.begin(), sample.timings.end(),
                         [&](const StageTiming& timing) { return timing.stage == stage; });
        csv << ",";
        if (found != sample.timings.end()) {
          csv << fmt::format("{:.4f}", static_cast<double>(found->duration_ns) / 1e6);
        }
      }
      csv << "\n";
    }
  }
}

}  // namespace

std::string progress_line(const Run& run) {
  const Summary& seen = run.windows.back();
  return fmt::format(
      "{}, window {}: {:.1f}/s OK, p50 {:.1f} ms, p99 {:.1f} ms, clock p99 {:.3f} ms; {}",
      run.rate_hz > 0 ? "asked " + rate_name(run) + "/s" : rate_name(run), run.windows.size(),
      seen.goodput_hz, seen.latency_ms.p50, seen.latency_ms.p99, seen.clock_error_ms.p99,
      ended_line(seen));
}

std::string load_report(const LoadResult& result) {
  std::string text = result.runs.size() == 1 ? one_run(result) : many_runs(result);
  if (result.capacity_hz) {
    text += fmt::format("\ncapacity  {:.2f}/s: the highest rate at which answers keep up\n",
                        *result.capacity_hz);
  }
  return text;
}

std::vector<std::string> reservations(const LoadResult& result) {
  std::vector<std::string> sentences;
  for (const Run& run : result.runs) {
    const Summary& seen = run.summary;
    if (load::is_late(seen)) {
      sentences.push_back(fmt::format(
          "{:.1f}/s is more than this machine can send: it sent {:.1f}/s, half of it over {:.0f} "
          "ms late; latency counts from when it should have been sent",
          seen.asked_hz, seen.sent_hz, seen.clock_error_ms.p50));
    }
    if (result.runs.size() == 1 && !run.is_stable) {
      sentences.push_back(
          "goodput and latency were not stable; take longer windows, or a lower rate");
    }
    if (result.capacity_hz && run.rate_hz > kAbove * *result.capacity_hz &&
        load::is_sustained(run)) {
      sentences.push_back(fmt::format(
          "{:.1f}/s was sustained, and less was not: something else took these machines' time "
          "while the capacity was looked for; measure again",
          run.rate_hz));
    }
    if (seen.ok_n == 0) {
      sentences.push_back(fmt::format("{}: not one request was answered OK ({})", rate_name(run),
                                      ended_line(seen)));
    }
  }
  return sentences;
}

Result<void> write_load(const std::filesystem::path& folder, const LoadResult& result) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  Json json;
  if (result.capacity_hz) json["capacity_fps"] = *result.capacity_hz;
  json["cells_n"] = result.cells.size();
  json["frame_bytes"] = result.frame_bytes;
  for (const Run& run : result.runs) json["runs"].push_back(to_json(run, result.cells));
  const auto write = [&](const std::string& name, const auto& content) -> Result<void> {
    std::ofstream file(folder / name);
    content(file);
    file.flush();
    if (!file) return invalid("{}: can't be written", (folder / name).string());
    return {};
  };
  auto ok = write("load.json", [&](std::ostream& file) { file << json.dump(2) << "\n"; });
  if (ok) ok = write("load.csv", [&](std::ostream& file) { write_requests(file, result); });
  if (ok) ok = write("load.svg", [&](std::ostream& file) { file << load_picture(result); });
  return ok;
}

}  // namespace graspd::program
