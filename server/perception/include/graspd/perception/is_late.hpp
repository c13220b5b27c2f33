#pragma once

#include <atomic>
#include <functional>

namespace graspd::perception {

/// Whether an answer would come too late, so that planning may end without one. Asked between the
/// pipeline's steps, from several threads at once; once true, it must stay true.
using IsLate = std::function<bool()>;

inline bool never_late() { return false; }

/// Asks from many threads, and no more once it is late.
class AskedOften {
 public:
  explicit AskedOften(const IsLate& is_late) : is_late_(is_late) {}
  bool is_late() {
    if (!was_late_ && is_late_()) was_late_ = true;
    return was_late_;
  }

 private:
  const IsLate& is_late_;
  std::atomic<bool> was_late_ = false;
};

}  // namespace graspd::perception
