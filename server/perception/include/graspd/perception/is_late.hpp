#pragma once

#include <functional>

namespace graspd::perception {

/// Whether an answer would come too late, so that planning may end without one. Asked between the
/// pipeline's steps, from several threads at once; once true, it must stay true.
using IsLate = std::function<bool()>;

inline bool never_late() { return false; }

}  // namespace graspd::perception
