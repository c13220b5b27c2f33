#pragma once

#include <atomic>
#include <filesystem>
#include <map>
#include <set>
#include <thread>
#include <vector>

#include "cells.hpp"
#include "folder_watch.hpp"

namespace graspd::console {

/// Tells `cells` of every flight and every record of a pick, in a thread of its own, as they are
/// written. Where many come at once, each cell's newest is read first, and its older ones while
/// there is nothing better to do.
class Watcher {
 public:
  Watcher(const std::vector<std::filesystem::path>& flights,
          const std::vector<std::filesystem::path>& records, Cells& cells);
  ~Watcher();
  Watcher(const Watcher&) = delete;
  Watcher& operator=(const Watcher&) = delete;

 private:
  /// The run that a cell began last; older ones are not looked at.
  struct LastRun {
    std::filesystem::path folder;
    std::streamoff read_bytes = 0;  ///< of its picks.jsonl
  };

  void run();
  void see(const std::set<std::filesystem::path>& files);
  void see_flights(const std::filesystem::path& folder, std::set<std::filesystem::path> files);
  void see_run(const std::filesystem::path& folder);
  void read_new_picks(const std::string& cell, LastRun& run);
  void read_plan_of(const std::filesystem::path& file);
  /// One flight that had to wait.
  void catch_up();

  Cells& cells_;
  FolderWatch watch_;
  std::map<std::filesystem::path, std::set<std::filesystem::path>> waiting_;  ///< by folder
  std::map<std::string, LastRun> runs_;                                       ///< by cell
  std::atomic<bool> stop_ = false;
  std::thread thread_;
};

}  // namespace graspd::console
