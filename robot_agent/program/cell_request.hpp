#pragma once

#include "cell_config.hpp"
#include "cell_frames.hpp"

namespace graspd::robot_agent {

/// What the cell asks a server with each frame, but for what it has learned while it picks.
/// \returns INVALID_ARGUMENT where the configuration makes no request that a server would take.
Result<PlanRequest> make_request(const CellConfig& config, const CellFrames& frames);

}  // namespace graspd::robot_agent
