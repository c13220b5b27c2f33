#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

#include "graspd/parts/mesh.hpp"

/// What tests of contact look up of a part, computed once when the catalogue loads.
namespace graspd::parts {

/// Template points side by side on the surface.
struct Patch {
  Eigen::Vector3f centre_m = Eigen::Vector3f::Zero();
  float radius_m = 0;  ///< from the centre to the farthest of its points
  std::uint32_t first = 0, points_n = 0;
};

/// What of a patch faces one way, as one point with the mean normal.
using Facet = SurfacePoint;

/// Spheres in separate arrays, for kernels that load many at once: of each array kPadding values
/// beyond the last can be read. They repeat it.
struct SphereArrays {
  static constexpr std::size_t kPadding = 32;
  std::vector<float> x_m, y_m, z_m, radius_m;
  std::size_t size = 0;

  void push_back(const Eigen::Vector3f& centre_m, float radius_of_it_m);
  /// Fills up to a multiple that kernels load: call it after the last `push_back`.
  void pad();
};

/// A grid of cells about a part, and how far each cell's centre is from the nearest template point.
struct DistanceGrid {
  static constexpr float kFar_m = 1e3F;  ///< stands for every distance that nobody asks for
  Eigen::Vector3f origin_m = Eigen::Vector3f::Zero();  ///< the lowest corner
  Eigen::Array3i size = Eigen::Array3i::Zero();
  float cells_per_m = 0;
  std::vector<float> distance_m;  ///< of each cell, x fastest; of the first, a corner: kFar_m
};

/// A part's template, so that points near another part, and what of that they are near to, are
/// found without a search: the points in patches, most of which are ruled out as a whole, and a
/// grid of cells about the part, each of which knows the point that is nearest to its centre.
class ContactModel {
 public:
  /// Whatever the part's size, no contact is asked for at a greater distance.
  static constexpr double kMaxDistance_m = 0.005;

  ContactModel() = default;
  explicit ContactModel(std::span<const SurfacePoint> surface);

  /// The template, patch by patch.
  const std::vector<SurfacePoint>& points() const { return points_; }
  const std::vector<Patch>& patches() const { return patches_; }
  /// The points, with no radius, and the patches, for kernels.
  const SphereArrays& point_spheres() const { return point_spheres_; }
  const SphereArrays& patch_spheres() const { return patch_spheres_; }
  /// No part that touches this one, by kMaxDistance_m, has a patch whose centre is in a far cell.
  const DistanceGrid& grid() const { return grid_; }
  /// The surface in coarse: about one for each patch, or two where it has an edge or two sides.
  const std::vector<Facet>& facets() const { return facets_; }

  /// A template point within `distance_m` ≤ kMaxDistance_m of a place, near the nearest one; null
  /// where there is none, and hardly ever where there is one.
  const SurfacePoint* find_within(const Eigen::Vector3f& p_m, float distance_m) const {
    const Eigen::Array3i cell = cell_of(p_m);
    const SurfacePoint* point = nearest_to(cell);
    if (point == nullptr) return nullptr;
    if ((point->position_m - p_m).squaredNorm() <= distance_m * distance_m) return point;
    return least_m(p_m, cell, *point) > distance_m ? nullptr : find_around(p_m, distance_m);
  }

 private:
  static constexpr std::uint32_t kNone = 0xFFFFFFFF;

  Eigen::Array3f in_cells(const Eigen::Vector3f& p_m) const {
    return (p_m - grid_.origin_m).array() * grid_.cells_per_m;
  }
  Eigen::Array3i cell_of(const Eigen::Vector3f& p_m) const {
    return in_cells(p_m).floor().cast<int>();
  }
  /// No template point is nearer to a place in this cell, of whose centre `nearest` is the nearest.
  float least_m(const Eigen::Vector3f& p_m, const Eigen::Array3i& cell,
                const SurfacePoint& nearest) const {
    const Eigen::Vector3f centre_m =
        grid_.origin_m.array() + (cell.cast<float>() + 0.5f) / grid_.cells_per_m;
    return (nearest.position_m - centre_m).norm() - (p_m - centre_m).norm();
  }
  /// Of the cell's centre; null where none is near.
  const SurfacePoint* nearest_to(const Eigen::Array3i& cell) const {
    if ((cell < 0).any() || (cell >= grid_.size).any()) return nullptr;
    const std::uint32_t point = nearest_[index_of(cell)];
    return point == kNone ? nullptr : &points_[point];
  }
  std::size_t index_of(const Eigen::Array3i& cell) const {
    return static_cast<std::size_t>((cell.z() * grid_.size.y() + cell.y()) * grid_.size.x() +
                                    cell.x());
  }
  /// Asks the eight cells whose centres surround the place.
  const SurfacePoint* find_around(const Eigen::Vector3f& p_m, float distance_m) const;

  void add_patches(std::span<const SurfacePoint> surface);
  void add_facets(std::span<const SurfacePoint> patch);
  void fill_cells(double cell_m, double reach_m);

  std::vector<SurfacePoint> points_;
  std::vector<Patch> patches_;
  std::vector<Facet> facets_;
  SphereArrays point_spheres_, patch_spheres_;
  DistanceGrid grid_;
  std::vector<std::uint32_t> nearest_;  ///< of each cell, x fastest
};

}  // namespace graspd::parts
