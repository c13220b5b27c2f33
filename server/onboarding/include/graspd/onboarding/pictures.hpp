#pragma once

#include "graspd/onboarding/stable_poses.hpp"
#include "graspd/overlay/overlay.hpp"
#include "graspd/parts/part.hpp"
#include "graspd/types/request.hpp"

namespace graspd::onboarding {

/// The part as it lies on a table.
overlay::RgbImage picture_of(const parts::Part& part, const StablePose& pose);

/// The gripper at a pick point, from above, its jaws as far open as they would be.
overlay::RgbImage picture_of(const parts::Part& part, const parts::PickPoint& point,
                             const Gripper& gripper);

}  // namespace graspd::onboarding
