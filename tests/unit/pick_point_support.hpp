#pragma once

#include <string>

#include "graspd/parts/part.hpp"
#include "part_test_support.hpp"

/// A box of 60 × 40 × 20 mm about its middle, with a pick point that is taught.
namespace graspd::parts {

inline Result<Part> box_with(const TestFolder& folder, const PickPoint& point,
                             const Mesh& mesh = box_mesh({-0.03F, -0.02F, -0.01F},
                                                         {0.06F, 0.04F, 0.02F})) {
  PartDescription description;
  description.id = "box";
  description.file = folder.path() / "part.yaml";
  description.mesh_file = folder.write("box.stl", to_stl(mesh, 1e3));
  description.pick_points.push_back(point);
  return make_part(description);
}

inline PickPoint across_the_box() {
  PickPoint point;
  point.name = "top";
  point.position_m = {0.01, 0, 0.002};
  point.closing = Eigen::Vector3d::UnitY();
  point.width_m = 0.040;
  point.gripper = "parallel_jaw";
  return point;
}

/// Those that are taught or proposed, of jaws or of cups.
inline std::vector<PickPoint> only(const Part& part, bool proposed, bool cups) {
  std::vector<PickPoint> points = part.pick_points;
  std::erase_if(points, [&](const PickPoint& point) {
    return point.is_proposed != proposed || (point.gripper == "suction") != cups;
  });
  return points;
}

}  // namespace graspd::parts
