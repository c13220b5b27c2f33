#pragma once

#include <atomic>
#include <functional>

namespace graspd::perception {

/// Whether an answer would come too late, so that planning may end without one. Asked between the
/// pipeline's steps, from several threads at once; once true, it must stay true.
using IsLate = std::function<bool()>;

inline bool never_late() { return false; }

/// For loops over many threads: once it has passed, nobody is asked again.
class Deadline {
 public:
  explicit Deadline(const IsLate& is_late) : is_late_(is_late) {}
  bool has_passed() {
    if (!has_passed_ && is_late_()) has_passed_ = true;
    return has_passed_;
  }

 private:
  const IsLate& is_late_;
  std::atomic<bool> has_passed_ = false;
};

}  // namespace graspd::perception
