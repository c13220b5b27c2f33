#include "cell_report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <numeric>
#include <set>
#include <stdexcept>
#include <utility>

#include "graspd/eval/interval.hpp"
#include "graspd/eval/quantile.hpp"

namespace graspd::bench {
namespace {

constexpr const char* kPicksHeader =
    "pipeline,part,seed,pick,verdict,others_moved_mm,planning_s,cpu_s,score,room_mm,why\n";
constexpr const char* kBinsHeader =
    "pipeline,part,seed,commit,parts,placed,duration_s,planning_s,wall_s,resets,reason\n";
/// As it was before resets were counted.
constexpr const char* kOldBinsHeader =
    "pipeline,part,seed,commit,parts,placed,duration_s,planning_s,wall_s,reason\n";
constexpr std::size_t kResets = 9;  ///< its column

std::string line_of(const BinKey& key, const PickRow& row) {
  return fmt::format("{},{},{},{},{},{:.2f},{:.4f},{:.3f},{:.3f},{:.0f},{}\n", key.pipeline,
                     key.part, key.seed, row.pick_n, row.verdict, 1e3 * row.others_moved_m,
                     row.planning_s, row.cpu_s, row.score, 1e3 * row.room_m, row.why);
}

std::string line_of(const BinKey& key, const BinRow& row) {
  return fmt::format("{},{},{},{},{},{},{:.3f},{:.3f},{:.2f},{},{}\n", key.pipeline, key.part,
                     key.seed, row.commit, row.parts_n, row.placed_n, row.duration_s,
                     row.planning_s, row.wall_s, row.resets_n ? fmt::to_string(*row.resets_n) : "",
                     row.reason);
}

void append(const std::filesystem::path& path, const std::string& text, bool truncate = false) {
  std::ofstream file(path, truncate ? std::ios::trunc : std::ios::app);
  file << text << std::flush;
  if (!file) throw std::runtime_error(path.string() + ": can't be written; is its folder there?");
}

/// The rows below the header; the last column may hold commas.
std::vector<std::vector<std::string>> rows_of(const std::filesystem::path& path) {
  std::vector<std::vector<std::string>> rows;
  std::ifstream file(path);
  std::string line;
  std::getline(file, line);
  const auto commas_n = static_cast<std::size_t>(std::ranges::count(line, ','));
  while (std::getline(file, line)) {
    std::vector<std::string> row;
    std::size_t from = 0, comma = 0;
    while (row.size() < commas_n && (comma = line.find(',', from)) != std::string::npos) {
      row.push_back(line.substr(from, comma - from));
      from = comma + 1;
    }
    // Otherwise the run was stopped while this line was written.
    if (row.size() < commas_n) continue;
    row.push_back(line.substr(from));
    rows.push_back(std::move(row));
  }
  return rows;
}

/// What stands above a file that is there.
std::string header_of(const std::filesystem::path& path) {
  std::ifstream file(path);
  std::string line;
  return std::getline(file, line) ? line + "\n" : "";
}

/// Of bins: rows from before resets were counted have an empty column for them.
std::vector<std::vector<std::string>> bin_rows_of(const std::filesystem::path& path) {
  auto rows = rows_of(path);
  if (header_of(path) != kOldBinsHeader) return rows;
  for (auto& row : rows) row.insert(row.begin() + kResets, "");
  return rows;
}

BinKey key_of(const std::vector<std::string>& row) { return {row[0], row[1], std::stoi(row[2])}; }

struct Sums {
  std::string part, pipeline;
  int bins_n = 0, picks_n = 0, success_n = 0, collision_n = 0, parts_n = 0, placed_n = 0;
  double duration_s = 0, planning_s = 0;
  std::vector<double> cpu_s, others_moved_mm;
  std::set<std::string> commits;

  double share(int hits_n, int all_n) const { return all_n == 0 ? 0 : double(hits_n) / all_n; }
  double picks_per_hour() const { return duration_s > 0 ? 3600 * placed_n / duration_s : 0; }
  double planning_share() const { return duration_s > 0 ? planning_s / duration_s : 0; }
  double mean(const std::vector<double>& values) const {
    return std::reduce(values.begin(), values.end()) / std::max(1.0, double(values.size()));
  }
  double median(const std::vector<double>& values) const {
    return values.empty() ? 0 : eval::quantile(values, 0.5);
  }
};

std::vector<Sums> sums_of(const std::vector<BinResult>& results) {
  std::vector<Sums> all;
  for (const BinResult& result : results) {
    auto sums = std::ranges::find_if(all, [&](const Sums& one) {
      return one.part == result.key.part && one.pipeline == result.key.pipeline;
    });
    if (sums == all.end()) {
      sums = all.insert(all.end(), Sums());
      sums->part = result.key.part;
      sums->pipeline = result.key.pipeline;
    }
    ++sums->bins_n;
    sums->commits.insert(result.bin.commit);
    sums->parts_n += result.bin.parts_n;
    sums->placed_n += result.bin.placed_n;
    sums->duration_s += result.bin.duration_s;
    sums->planning_s += result.bin.planning_s;
    for (const PickRow& pick : result.picks) {
      ++sums->picks_n;
      sums->success_n += pick.verdict == "SUCCESS";
      sums->collision_n += pick.verdict == "COLLISION";
      sums->cpu_s.push_back(pick.cpu_s);
      sums->others_moved_mm.push_back(1e3 * pick.others_moved_m);
    }
  }
  return all;
}

std::string percent(int hits_n, int all_n) {
  const eval::Interval interval = eval::wilson(hits_n, all_n);
  return fmt::format("{:.1f} ({:.1f}–{:.1f})", all_n == 0 ? 0 : 100.0 * hits_n / all_n,
                     100 * interval.low, 100 * interval.high);
}

}  // namespace

CellLog::CellLog(const std::string& stem, bool fresh)
    : picks_path_(stem + "_picks.csv"), bins_path_(stem + "_bins.csv") {
  if (!fresh) read();
  rewrite();
}

void CellLog::read() {
  for (const auto& [path, header] :
       {std::pair(bins_path_, kBinsHeader), {picks_path_, kPicksHeader}}) {
    const std::string found = header_of(path);
    const bool is_old = header == kBinsHeader && found == kOldBinsHeader;
    if (found.empty() || found == header || is_old) continue;
    throw std::runtime_error(path.string() +
                             ": has other columns than this program's; move it away, or begin anew "
                             "with --fresh");
  }
  for (const auto& row : bin_rows_of(bins_path_)) {
    const std::string& resets = row[kResets];
    at(key_of(row)).bin = {row[3],
                           std::stoi(row[4]),
                           std::stoi(row[5]),
                           std::stod(row[6]),
                           std::stod(row[7]),
                           std::stod(row[8]),
                           resets.empty() ? std::nullopt : std::optional(std::stoi(resets)),
                           row[10]};
    done_.push_back(key_of(row));
  }
  for (const auto& row : rows_of(picks_path_)) {
    if (!has(key_of(row))) continue;
    at(key_of(row))
        .picks.push_back({std::stoi(row[3]), row[4], row[10], 1e-3 * std::stod(row[5]),
                          std::stod(row[6]), std::stod(row[7]), std::stod(row[8]),
                          1e-3 * std::stod(row[9])});
  }
}

void CellLog::rewrite() {
  std::string picks = kPicksHeader, bins = kBinsHeader;
  for (const BinResult& result : results_) {
    for (const PickRow& pick : result.picks) picks += line_of(result.key, pick);
    bins += line_of(result.key, result.bin);
  }
  append(picks_path_, picks, true);
  append(bins_path_, bins, true);
}

BinResult& CellLog::at(const BinKey& key) {
  const auto known = std::ranges::find(results_, key, &BinResult::key);
  return known == results_.end() ? results_.emplace_back(BinResult{key, {}, {}}) : *known;
}

bool CellLog::has(const BinKey& key) const { return std::ranges::find(done_, key) != done_.end(); }

void CellLog::add(const BinKey& key, const PickRow& pick) {
  at(key).picks.push_back(pick);
  append(picks_path_, line_of(key, pick));
}

void CellLog::add(const BinKey& key, const BinRow& bin) {
  at(key).bin = bin;
  done_.push_back(key);
  append(bins_path_, line_of(key, bin));
}

Table cell_table(const std::vector<BinResult>& results) {
  Table table({"part", "pipeline", "bins", "picks", "success %", "collision %", "emptied %",
               "picks per hour", "planning %", "others moved, median mm", "CPU s a pick, mean",
               "commit"});
  for (const Sums& sums : sums_of(results)) {
    table.add({sums.part, sums.pipeline, fmt::to_string(sums.bins_n), fmt::to_string(sums.picks_n),
               percent(sums.success_n, sums.picks_n), percent(sums.collision_n, sums.picks_n),
               percent(sums.placed_n, sums.parts_n), fmt::format("{:.0f}", sums.picks_per_hour()),
               fmt::format("{:.1f}", 100 * sums.planning_share()),
               fmt::format("{:.1f}", sums.median(sums.others_moved_mm)),
               fmt::format("{:.2f}", sums.mean(sums.cpu_s)),
               fmt::format("{}", fmt::join(sums.commits, ", "))});
  }
  return table;
}

nlohmann::json cell_figures(const std::vector<BinResult>& results) {
  nlohmann::json figures;
  for (const Sums& sums : sums_of(results)) {
    const eval::Interval success = eval::wilson(sums.success_n, sums.picks_n);
    const eval::Interval collision = eval::wilson(sums.collision_n, sums.picks_n);
    figures[sums.part][sums.pipeline] = {{"bins", sums.bins_n},
                                         {"picks", sums.picks_n},
                                         {"success", sums.share(sums.success_n, sums.picks_n)},
                                         {"success_interval", {success.low, success.high}},
                                         {"collision", sums.share(sums.collision_n, sums.picks_n)},
                                         {"collision_interval", {collision.low, collision.high}},
                                         {"emptied", sums.share(sums.placed_n, sums.parts_n)},
                                         {"picks_per_hour", sums.picks_per_hour()},
                                         {"planning_share", sums.planning_share()},
                                         {"cpu_s_per_pick", sums.mean(sums.cpu_s)}};
  }
  return figures;
}

}  // namespace graspd::bench
