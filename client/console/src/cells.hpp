#pragma once

#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <deque>
#include <map>
#include <mutex>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "graspd/pick_records/runs.hpp"

namespace graspd::console {

/// Of each cell; what is older is forgotten.
inline constexpr std::size_t kMostPlans_n = 120;
/// The one that was heard of longest ago makes room.
inline constexpr std::size_t kMostCells_n = 500;

/// One line of a cell's history.
struct PlanSeen {
  std::string cell;
  std::string flight;  ///< CELL_FOLDER/TIME_ID.flight; sorted, they are in the order of time
  double stamp_s = 0;
  std::string code;
  std::string outcome;
  std::string message;
  std::size_t objects_n = 0;
  std::size_t grasps_n = 0;
  double server_ms = 0;
  std::optional<double> fill_level;
};

/// One event of the page's stream.
struct Event {
  std::string name;
  std::string data;  ///< JSON, in one line
};

/// What is known of the cells. Any thread may call.
class Cells {
 public:
  void add(PlanSeen plan);
  /// Counting starts again.
  void begin_run(const std::string& cell);
  void add(const std::string& cell, const pick_records::PickLine& line);
  void set_run_state(const pick_records::Run& run);
  void set_servers(std::string json);
  /// Lets everybody who waits go on.
  void wake();

  /// Every cell as it is now, if it changed since `seen`: whoever is slow gets the newest, not all.
  /// Waits for a change until the time is up, or `wake` is called. \param seen is moved on
  std::vector<Event> changes_since(std::uint64_t& seen, std::chrono::milliseconds patience);
  /// The plans of a cell with what became of them, oldest first, as JSON.
  std::string history(const std::string& cell) const;

 private:
  struct Cell {
    std::deque<PlanSeen> plans;
    std::deque<std::pair<std::string, nlohmann::json>> picks;  ///< by request id
    std::deque<double> cycles_s;
    std::optional<double> round_trip_ms;
    std::uint64_t picks_n = 0;
    std::uint64_t placed_n = 0;
    std::string run_state;
    std::string run_reason;
    std::string alarm;
    nlohmann::json last_pick;
    std::uint64_t version = 0;
  };

  Cell& touch(const std::string& name);
  static nlohmann::json summary(const std::string& name, const Cell& cell);

  mutable std::mutex mutex_;
  std::condition_variable changed_;
  std::map<std::string, Cell> cells_;
  std::string servers_;
  std::uint64_t servers_version_ = 0;
  std::uint64_t version_ = 0;
  std::uint64_t woken_n_ = 0;
};

}  // namespace graspd::console
