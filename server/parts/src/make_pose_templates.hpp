#pragma once

#include <span>

#include "graspd/parts/pose_templates.hpp"
#include "graspd/parts/registration_model.hpp"

namespace graspd::parts {

/// Of views that a symmetry makes equal only the first has templates.
/// \param points of the views, `cell_m` apart across the line of sight.
PoseTemplates make_pose_templates(std::span<const View> views, const PointArrays& points,
                                  double diameter_m, double cell_m, const Symmetries& symmetries);

}  // namespace graspd::parts
