#include "graspd/parts/part.hpp"

#include <algorithm>
#include <utility>

#include "length_unit.hpp"
#include "mesh_geometry.hpp"
#include "mesh_topology.hpp"
#include "pick_point_images.hpp"
#include "propose_pick_points.hpp"
#include "taught_pick_points.hpp"

namespace graspd::parts {
namespace {

// A pixel of a Kinect v2 at 0.73 m.
constexpr double kTemplateSpacing_m = 0.002;

Result<void> check_size(const PartDescription& description, double diameter_m) {
  if (diameter_m >= kMinDiameter_m && diameter_m <= kMaxDiameter_m) return {};
  return invalid("part '{}': with mesh_unit '{}' the mesh {} is {:.4g} mm across, and {}",
                 description.id, name_of(description.mesh_unit), description.mesh_file.string(),
                 diameter_m * 1e3, probable_unit(diameter_m, description.mesh_unit));
}

/// Some exporters write solids inside out, or some of their triangles; what follows wants normals
/// that point outwards.
void turn_outwards(Mesh& mesh) {
  const auto turn_over = [](std::array<int, 3>& triangle) { std::swap(triangle[1], triangle[2]); };
  for (const std::size_t i : analyse_topology(mesh).reversed_triangles) {
    turn_over(mesh.triangles[i]);
  }
  if (is_inside_out(mesh)) std::ranges::for_each(mesh.triangles, turn_over);
}

/// The taught ones, then the proposed ones below any of their priorities, all with their images.
std::vector<PickPoint> with_images(const std::vector<PickPoint>& taught,
                                   std::vector<PickPoint> proposed, const Symmetries& symmetries) {
  double lowest = 0;
  for (const PickPoint& point : taught) lowest = std::min(lowest, point.priority);
  // At half of their quality, so that no approach nearer to vertical makes up for the difference.
  for (PickPoint& point : proposed) point.priority = lowest - 1 + point.priority / 2;
  const auto turns = turns_of(symmetries);
  std::vector<PickPoint> all;
  const auto add_unless_known = [&all](PickPoint& image) {
    const bool is_known = std::ranges::any_of(
        all, [&](const PickPoint& known) { return is_same_grasp(known, image); });
    if (!is_known) all.push_back(std::move(image));
  };
  for (const auto* points : {&taught, &std::as_const(proposed)}) {
    for (const PickPoint& point : *points) {
      for (PickPoint& image : images_of(point, turns)) add_unless_known(image);
    }
  }
  return all;
}

}  // namespace

Result<Part> make_part(const PartDescription& description) {
  auto mesh = load_mesh(description.mesh_file, description.mesh_unit);
  if (!mesh) {
    return invalid("part '{}': {}", description.id, mesh.error().message);
  }
  Part part;
  part.diameter_m = diameter_m(*mesh);
  if (auto size = check_size(description, part.diameter_m); !size) {
    return tl::unexpected(size.error());
  }
  if (surface_area_m2(*mesh) <= 0) {
    return invalid("part '{}': the triangles of {} have no area; export the part again",
                   description.id, description.mesh_file.string());
  }
  turn_outwards(*mesh);
  part.id = description.id;
  part.name = description.name;
  part.bop_obj_id = description.bop_obj_id;
  part.surface_area_m2 = surface_area_m2(*mesh);
  part.barycentre_m = barycentre_m(*mesh);
  part.principal_axes = principal_axes(*mesh);
  part.surface = sample_surface(*mesh, kTemplateSpacing_m);
  for (const SurfacePoint& point : part.surface) {
    const Eigen::Vector3d d_m = point.position_m.cast<double>() - part.barycentre_m;
    part.radius_m = std::max(part.radius_m, d_m.norm());
  }
  part.contact = ContactModel(part.surface);
  part.symmetries = description.symmetries ? *description.symmetries : find_symmetries(*mesh);
  part.registration = RegistrationModel(*mesh, part.symmetries);
  part.triangles = TriangleGroups(*mesh);
  part.mesh = std::move(*mesh);
  auto taught = taught_pick_points(description, part.mesh);
  if (!taught) return tl::unexpected(taught.error());
  part.pick_points = with_images(*taught, propose_pick_points(part), part.symmetries);
  part.color_rgb = description.color_rgb;
  return part;
}

}  // namespace graspd::parts
