#pragma once

#include <Eigen/Core>
#include <vector>

#include "antipodal_pairs.hpp"
#include "graspd/parts/mesh.hpp"

namespace graspd::parts {

/// Approaches across the closing direction from which an open gripper reaches a pair.
struct ApproachSector {
  Eigen::Vector3d approach;  ///< unit, in its middle
  double cone_rad = 0;       ///< to either side; π: any approach
};

/// By the request's default gripper, opened by its clearance: neither jaws nor palm may meet the
/// part on the way in, nor a jaw anything but the pair as it closes. The widest sector first.
std::vector<ApproachSector> approach_sectors(const AntipodalPair& pair, double tip_reach_m,
                                             const std::vector<SurfacePoint>& surface);

}  // namespace graspd::parts
