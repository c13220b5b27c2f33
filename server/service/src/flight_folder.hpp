#pragma once

#include <cstdint>
#include <deque>
#include <filesystem>
#include <map>
#include <string>

#include "graspd/types/result.hpp"

namespace graspd::service {

struct FlightLimits {
  std::size_t per_cell_n = 100;
  std::uint64_t bytes = 0;  ///< in all
};

/// A folder of files that never grows above its limits: FOLDER/CELL/NAME. Above `per_cell_n` the
/// cell's oldest goes, above `bytes` the oldest of all. What a crash interrupts leaves no file that
/// looks whole. One folder belongs to one server at a time. Readable by its user alone.
class FlightFolder {
 public:
  FlightFolder(std::filesystem::path folder, const FlightLimits& limits)
      : folder_(std::move(folder)), limits_(limits) {}
  ~FlightFolder();
  FlightFolder(const FlightFolder&) = delete;
  FlightFolder& operator=(const FlightFolder&) = delete;

  /// Where `add` will put it.
  std::filesystem::path path_of(const std::string& cell, const std::string& name) const;
  /// The folder is made, and what is in it from an earlier server is counted, with the first one.
  /// Names are to be greater than all before.
  /// \returns INTERNAL with the reason why it could not be kept; nothing of it is left then.
  Result<void> add(const std::string& cell, const std::string& name, const std::string& bytes);

 private:
  struct File {
    std::string name;
    std::uint64_t bytes = 0;
  };
  using Cells = std::map<std::string, std::deque<File>>;  ///< by folder, the oldest file first

  Result<void> open();
  void count_what_is_there();
  void make_room(const std::string& cell_folder, std::uint64_t bytes);
  void remove_oldest(Cells::iterator cell);

  std::filesystem::path folder_;
  FlightLimits limits_;
  int lock_fd_ = -1;
  Cells cells_;
  std::uint64_t bytes_ = 0;
};

}  // namespace graspd::service
