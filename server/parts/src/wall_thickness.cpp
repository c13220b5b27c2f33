#include "wall_thickness.hpp"

#include "triangle_tree.hpp"
#include "visit_surface.hpp"

namespace graspd::parts {
namespace {

constexpr double kMeasurements = 400;

}  // namespace

std::vector<double> wall_thicknesses_m(const Mesh& mesh) {
  const TriangleTree tree(mesh);
  const double inwards = signed_volume_m3(mesh) < 0 ? 1 : -1;
  std::vector<double> thicknesses_m;
  visit_surface(mesh, kMeasurements / surface_area_m2(mesh), [&](const SurfacePoint& point) {
    const auto hit = tree.first_hit(point.position_m.cast<double>(),
                                    inwards * point.normal.cast<double>().normalized(), kItself_m);
    thicknesses_m.push_back(hit.distance_m);
  });
  return thicknesses_m;
}

}  // namespace graspd::parts
