#pragma once

#include <Eigen/Geometry>
#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "graspd/parts/contact_model.hpp"
#include "graspd/parts/mesh.hpp"
#include "graspd/parts/pick_point.hpp"
#include "graspd/parts/registration_model.hpp"
#include "graspd/parts/symmetries.hpp"
#include "graspd/parts/triangle_groups.hpp"

namespace graspd::parts {

/// A part with all that is computed of it once. Frame: that of its mesh, in metres.
struct Part {
  std::string id;
  std::string name;
  int bop_obj_id = 0;  ///< its number in BOP scenes
  Mesh mesh;
  double diameter_m = 0;
  double surface_area_m2 = 0;
  Eigen::Vector3d barycentre_m = Eigen::Vector3d::Zero();
  /// Principal axes of the surface as columns, longest extent first, right-handed.
  Eigen::Matrix3d principal_axes = Eigen::Matrix3d::Identity();
  Symmetries symmetries;
  /// The taught ones, then the proposed ones, each followed by its images under the symmetries.
  std::vector<PickPoint> pick_points;
  std::array<std::uint8_t, 3> color_rgb{200, 200, 200};
  std::vector<SurfacePoint> surface;  ///< the template: points about a pixel of the sensor apart
  double radius_m = 0;                ///< from the barycentre to the farthest of them
  ContactModel contact;               ///< the template again, for tests of contact
  RegistrationModel registration;     ///< what registration looks up
  TriangleGroups triangles;           ///< the mesh, for collision checks
};

/// What a part is besides its mesh: the content of part.yaml.
struct PartDescription {
  std::filesystem::path file;  ///< it was read from
  std::string id;
  std::string name;
  int bop_obj_id = 0;
  std::filesystem::path mesh_file;
  LengthUnit mesh_unit = LengthUnit::kMillimetre;
  std::optional<Symmetries> symmetries;  ///< absent: those found in the mesh
  std::vector<PickPoint> pick_points;
  std::array<std::uint8_t, 3> color_rgb{200, 200, 200};
};

/// Computes everything that is derived from the mesh.
/// \returns INVALID_ARGUMENT where the mesh can't be a part: no triangles, or a size that says that
/// its unit is wrong (below 2 mm or above 2 m); and where a taught pick point contradicts the mesh.
Result<Part> make_part(const PartDescription& description);

/// Reads part.yaml and the mesh beside it.
Result<PartDescription> read_part_file(const std::filesystem::path& path);

}  // namespace graspd::parts
