#pragma once

#include <chrono>
#include <filesystem>
#include <map>
#include <set>
#include <vector>

namespace graspd::console {

/// Says which files in some folders, however deep, were written. By inotify: nothing is read again
/// and again.
class FolderWatch {
 public:
  /// \param roots need not be there yet. \param skipped names of folders that are not looked into
  FolderWatch(std::vector<std::filesystem::path> roots, std::set<std::string> skipped);
  ~FolderWatch();
  FolderWatch(const FolderWatch&) = delete;
  FolderWatch& operator=(const FolderWatch&) = delete;

  /// Files written since the last call, each once; with the first call, and where the kernel lost
  /// count, all there are.
  std::set<std::filesystem::path> wait(std::chrono::milliseconds patience);

 private:
  void add(const std::filesystem::path& folder, std::set<std::filesystem::path>& files);
  void read_events(std::set<std::filesystem::path>& files);

  std::vector<std::filesystem::path> roots_;
  std::set<std::string> skipped_;
  std::map<int, std::filesystem::path> folders_;
  std::set<std::filesystem::path> watched_;
  int fd_ = -1;
};

}  // namespace graspd::console
