#pragma once

#include <string>
#include <vector>

#include "graspd/parts/catalogue.hpp"
#include "graspd/types/frame.hpp"
#include "graspd/types/request.hpp"

namespace graspd::perception {

using PartList = std::vector<const parts::Part*>;

/// Everything that can be wrong with a call. \returns the requested parts.
Result<PartList> check_request(const DepthFrame& frame, const PlanRequest& request,
                               const parts::Catalogue& catalogue);

/// A sentence for each part that shows fewer pixels than its pose can be told from.
std::vector<std::string> too_small_parts(const PartList& parts, const CameraIntrinsics& camera,
                                         double distance_m, double least_px);

}  // namespace graspd::perception
