#pragma once

#include <opencv2/core.hpp>

#include "graspd/overlay/overlay.hpp"
#include "graspd/types/frame.hpp"
#include "graspd/types/request.hpp"

namespace graspd::overlay {

/// The view's part of the depth image in grey (BGR). The contrast is that of what lies in the
/// request's bin or crop box; a far wall does not flatten the parts.
cv::Mat depth_picture(const DepthFrame& frame, const PlanRequest& request, const View& view);

}  // namespace graspd::overlay
