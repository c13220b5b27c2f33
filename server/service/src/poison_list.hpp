#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <map>

namespace graspd::service {

/// Which requests have cost workers their life. One death may be the machine's fault; a request
/// that was being computed at two is not tried a third time. Remembers the last `kMost_n` suspects,
/// so that its size does not depend on what clients send. Not thread-safe.
class PoisonList {
 public:
  static constexpr int kDeaths_n = 2;
  static constexpr std::size_t kMost_n = 1024;

  /// A worker died, or had to be ended, while it computed this. \returns true when that makes it
  /// poison.
  bool add_death(std::uint64_t content);
  bool contains(std::uint64_t content) const;

 private:
  std::map<std::uint64_t, int> deaths_n_;
  std::deque<std::uint64_t> oldest_first_;
};

}  // namespace graspd::service
