#pragma once

#include <optional>
#include <string>

#include "graspd/types/frame.hpp"
#include "graspd/types/request.hpp"

namespace graspd::perception {

/// A warning where many pixels that look into the bin have no reading. Parts that are not seen are
/// not found, and an answer of the rest would look complete.
std::optional<std::string> missing_readings(const DepthFrame& frame, const PlanRequest& request);

}  // namespace graspd::perception
