#pragma once

#include <string>

#include "graspd/types/envelope.hpp"

namespace graspd::service {

/// Encodes an answer that clients will accept. What was asked for on top (rejected grasps, then
/// outlines) is left out with a warning where the answer is too large; what is still too large
/// becomes an INTERNAL answer. Changes `answer` to what was encoded.
std::string encode_within_limit(Answer& answer);

}  // namespace graspd::service
