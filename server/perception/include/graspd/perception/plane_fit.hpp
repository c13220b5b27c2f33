#pragma once

#include <Eigen/Core>
#include <vector>

#include "graspd/perception/cloud.hpp"

namespace graspd::perception {

/// Fits a plane to each reading of a depth image and its neighbours within three pixels on the same
/// surface, in the widest vectors that the machine has.
/// \param z_m of each cell; 0: no reading.
/// \param normals of each cell, towards the camera; 0 where too little of a surface is seen.
/// \param curvatures of each cell: the variance across the plane over that in all directions, at
/// most 1/3; 0 where there is no normal.
void fit_planes(const std::vector<float>& z_m, const PixelGrid& pixels,
                std::vector<Eigen::Vector3f>& normals, std::vector<float>& curvatures);

}  // namespace graspd::perception
