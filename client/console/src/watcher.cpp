#include "watcher.hpp"

#include <algorithm>
#include <fstream>

#include "flight_files.hpp"
#include "graspd/types/flight.hpp"

namespace graspd::console {
namespace {

namespace fs = std::filesystem;
using std::chrono::milliseconds;

constexpr milliseconds kPatience{100};
// A hundred cells have four thousand of them when the console starts.
constexpr std::size_t kMostWaiting_n = 40;

std::vector<fs::path> both(std::vector<fs::path> flights, const std::vector<fs::path>& records) {
  flights.insert(flights.end(), records.begin(), records.end());
  return flights;
}

}  // namespace

Watcher::Watcher(const std::vector<fs::path>& flights, const std::vector<fs::path>& records,
                 Cells& cells)
    : cells_(cells),
      watch_(both(flights, records), {"frames", "requests", "answers", "overlays"}),
      thread_([this] { run(); }) {}

Watcher::~Watcher() {
  stop_ = true;
  thread_.join();
}

void Watcher::run() {
  while (!stop_) {
    const auto files = watch_.wait(waiting_.empty() ? kPatience : milliseconds(0));
    if (files.empty() && !waiting_.empty()) {
      catch_up();
    } else {
      see(files);
    }
  }
}

void Watcher::see(const std::set<fs::path>& files) {
  std::map<fs::path, std::set<fs::path>> flights;
  std::set<fs::path> runs;
  for (const fs::path& file : files) {
    if (file.extension() == kFlightExtension) flights[file.parent_path()].insert(file);
    const fs::path name = file.filename();
    if (name == "run.json" || name == "picks.jsonl") runs.insert(file.parent_path());
  }
  for (auto& [folder, of_cell] : flights) see_flights(folder, std::move(of_cell));
  for (const fs::path& folder : runs) see_run(folder);
}

void Watcher::see_flights(const fs::path& folder, std::set<fs::path> files) {
  read_plan_of(files.extract(std::prev(files.end())).value());
  if (files.empty()) return;
  auto& waiting = waiting_[folder];
  waiting.merge(files);
  while (waiting.size() > kMostWaiting_n) waiting.erase(waiting.begin());
}

void Watcher::catch_up() {
  const auto folder = waiting_.begin();
  read_plan_of(folder->second.extract(std::prev(folder->second.end())).value());
  if (folder->second.empty()) waiting_.erase(folder);
}

void Watcher::read_plan_of(const fs::path& file) {
  // What is damaged, or was taken away since, is not shown: the server's log speaks of it.
  if (auto plan = read_plan(file)) cells_.add(*std::move(plan));
}

void Watcher::see_run(const fs::path& folder) {
  const auto run = pick_records::read_run_state(folder);
  if (!run) return;  // its first line is yet to come
  auto& known = runs_[run->cell];
  // Their names end with the time, and begin alike.
  if (folder.filename() < known.folder.filename()) return;
  if (folder != known.folder) {
    known = {folder};
    cells_.begin_run(run->cell);
  }
  cells_.set_run_state(*run);
  read_new_picks(run->cell, known);
}

void Watcher::read_new_picks(const std::string& cell, LastRun& run) {
  std::ifstream file(run.folder / "picks.jsonl");
  file.seekg(run.read_bytes);
  std::string text;
  while (std::getline(file, text) && !file.eof()) {
    run.read_bytes = file.tellg();
    if (const auto line = pick_records::parse_pick_line(text)) cells_.add(cell, *line);
  }
}

}  // namespace graspd::console
