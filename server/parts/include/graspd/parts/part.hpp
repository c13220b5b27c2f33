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
#include "graspd/parts/registration_model.hpp"
#include "graspd/parts/symmetries.hpp"

namespace graspd::parts {

/// A place to grasp, taught in the part file, in the part frame.
struct PickPoint {
  std::string name;
  Eigen::Vector3d position_m = Eigen::Vector3d::Zero();
  Eigen::Vector3d approach = -Eigen::Vector3d::UnitZ();  ///< unit, into the part
  Eigen::Vector3d closing = Eigen::Vector3d::UnitX();    ///< unit, jaw to jaw
  double approach_cone_rad = 0.5;                        ///< half angle that is allowed
  double width_m = 0;                                    ///< of the part between the jaws
  double priority = 0;
  std::string gripper;  ///< kind it is for; empty: any
};

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
  std::vector<PickPoint> pick_points;
  std::array<std::uint8_t, 3> color_rgb{200, 200, 200};
  std::vector<SurfacePoint> surface;  ///< the template: points about a pixel of the sensor apart
  double radius_m = 0;                ///< from the barycentre to the farthest of them
  ContactModel contact;               ///< the template again, for tests of contact
  RegistrationModel registration;     ///< what registration looks up
};

/// What a part is besides its mesh: the content of part.yaml.
struct PartDescription {
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
/// its unit is wrong (below 2 mm or above 2 m).
Result<Part> make_part(const PartDescription& description);

/// Reads part.yaml and the mesh beside it.
Result<PartDescription> read_part_file(const std::filesystem::path& path);

}  // namespace graspd::parts
