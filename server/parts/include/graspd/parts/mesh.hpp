#pragma once

#include <Eigen/Core>
#include <array>
#include <filesystem>
#include <string>
#include <vector>

#include "graspd/types/result.hpp"

namespace graspd::parts {

/// What the numbers of a mesh file are in: the formats don't say.
enum class LengthUnit { kMetre, kMillimetre, kInch };

/// A triangle mesh in metres, vertices merged, triangles counter-clockwise seen from outside.
struct Mesh {
  std::vector<Eigen::Vector3f> vertices_m;
  std::vector<std::array<int, 3>> triangles;
};

/// Reads STL, PLY or OBJ.
/// \returns INVALID_ARGUMENT where the file is missing, unreadable or has no triangle.
Result<Mesh> load_mesh(const std::filesystem::path& path, LengthUnit unit);

/// Of a closed mesh; below 0 where it is inside out.
double signed_volume_m3(const Mesh& mesh);
/// Of all triangles, hidden ones included.
double surface_area_m2(const Mesh& mesh);
/// Of the whole solid with uniform density; of the surface where the mesh is not closed.
Eigen::Vector3d barycentre_m(const Mesh& mesh);
/// Largest distance between two vertices.
double diameter_m(const Mesh& mesh);

/// Part frame.
struct SurfacePoint {
  Eigen::Vector3f position_m;
  Eigen::Vector3f normal;  ///< unit length, outwards
};

/// Points spread evenly over the surface, about `spacing_m` apart, the same for the same mesh.
std::vector<SurfacePoint> sample_surface(const Mesh& mesh, double spacing_m);

}  // namespace graspd::parts

template <>
struct graspd::EnumNames<graspd::parts::LengthUnit> {
  static constexpr std::string_view what = "unit";
  static constexpr std::pair<parts::LengthUnit, std::string_view> values[] = {
      {parts::LengthUnit::kMetre, "m"},
      {parts::LengthUnit::kMillimetre, "mm"},
      {parts::LengthUnit::kInch, "in"}};
};
