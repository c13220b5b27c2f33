#include "graspd/pick_records/runs.hpp"

#include <algorithm>
#include <fstream>
#include <nlohmann/json.hpp>

namespace graspd::pick_records {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

PickLine pick_line(const Json& json) {
  PickLine line;
  line.frame_n = json.at("frame");
  line.start_s = json.at("start_s");
  line.end_s = json.at("end_s");
  line.code = json.at("code");
  line.outcome = json.value("outcome", "");
  line.message = json.value("message", "");
  line.verdict = json.value("verdict", "");
  line.request_id = json.value("request_id", "");
  if (json.contains("grasp")) {
    line.part = json["grasp"].at("part");
    line.rank = json["grasp"].at("rank");
  }
  for (const Json& over : json.value("passed_over", Json::array())) {
    line.passed_over.push_back({over.at("rank"), over.at("reason")});
  }
  line.is_alarmed = json.contains("alarm");
  const Json& ms = json.at("ms");
  for (const char* step : {"acquire", "plan", "choose"}) {
    line.steps_ms.emplace_back(step, ms.at(step));
  }
  for (const Json& step : ms.value("steps", Json::array())) {
    line.steps_ms.emplace_back(step.at(0), step.at(1));
  }
  return line;
}

Result<std::vector<PickLine>> read_picks(const fs::path& path) {
  std::vector<PickLine> picks;
  std::ifstream file(path);
  std::string text;
  for (int line_n = 1; std::getline(file, text); ++line_n) {
    const bool is_cut_off = file.eof();
    if (is_cut_off) break;
    auto line = parse_pick_line(text);
    if (!line) return invalid("{}:{}: {}", path.string(), line_n, line.error().message);
    picks.push_back(*std::move(line));
  }
  return picks;
}

Result<Run> read_run(const fs::path& folder) {
  auto run = read_run_state(folder);
  if (!run) return run;
  auto picks = read_picks(folder / "picks.jsonl");
  if (!picks) return tl::unexpected(picks.error());
  run->picks = *std::move(picks);
  return run;
}

}  // namespace

Result<PickLine> parse_pick_line(std::string_view json) {
  try {
    return pick_line(Json::parse(json));
  } catch (const Json::exception& e) {
    return invalid("no record of a pick ({})", e.what());
  }
}

Result<Run> read_run_state(const fs::path& folder) {
  Run run;
  run.folder = folder;
  std::ifstream file(folder / "run.json");
  try {
    const Json json = Json::parse(file);
    run.cell = json.at("cell");
    run.state = json.at("state");
    run.reason = json.at("reason");
  } catch (const Json::exception& e) {
    return invalid("{}: says nothing about the run ({})", (folder / "run.json").string(), e.what());
  }
  return run;
}

std::vector<fs::path> run_folders(const fs::path& folder) {
  std::error_code error;
  if (fs::exists(folder / "picks.jsonl", error)) return {folder};
  std::vector<fs::path> folders;
  for (fs::recursive_directory_iterator it(folder, error), end; !error && it != end;
       it.increment(error)) {
    if (it->path().filename() == "picks.jsonl") folders.push_back(it->path().parent_path());
  }
  std::ranges::sort(folders);
  return folders;
}

Result<std::vector<Run>> read_runs(const fs::path& folder) {
  std::vector<Run> runs;
  for (const fs::path& path : run_folders(folder)) {
    auto run = read_run(path);
    if (!run) return tl::unexpected(run.error());
    runs.push_back(*std::move(run));
  }
  if (runs.empty()) {
    return invalid("{}: no run here; it has a picks.jsonl, written by `robot_agent run`",
                   folder.string());
  }
  return runs;
}

}  // namespace graspd::pick_records
