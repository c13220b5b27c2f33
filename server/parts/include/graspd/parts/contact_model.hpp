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
  /// Whether a template point may be within `distance_m` ≤ kMaxDistance_m of a patch that lies
  /// here; `radius_m` as patches have. Never says no where one is.
  bool may_touch(const Eigen::Vector3f& centre_m, float radius_m, float distance_m) const {
    const Eigen::Array3i cell = cell_of(centre_m);
    const SurfacePoint* point = nearest_to(cell);
    return point != nullptr && least_m(centre_m, cell, *point) <= radius_m + distance_m;
  }

 private:
  static constexpr std::uint32_t kNone = 0xFFFFFFFF;

  Eigen::Array3f in_cells(const Eigen::Vector3f& p_m) const {
    return (p_m - origin_m_).array() * cells_per_m_;
  }
  Eigen::Array3i cell_of(const Eigen::Vector3f& p_m) const {
    return in_cells(p_m).floor().cast<int>();
  }
  /// No template point is nearer to a place in this cell, of whose centre `nearest` is the nearest.
  float least_m(const Eigen::Vector3f& p_m, const Eigen::Array3i& cell,
                const SurfacePoint& nearest) const {
    const Eigen::Vector3f centre_m = origin_m_.array() + (cell.cast<float>() + 0.5f) / cells_per_m_;
    return (nearest.position_m - centre_m).norm() - (p_m - centre_m).norm();
  }
  /// Of the cell's centre; null where none is near.
  const SurfacePoint* nearest_to(const Eigen::Array3i& cell) const {
    if ((cell < 0).any() || (cell >= size_).any()) return nullptr;
    const std::uint32_t point = nearest_[index_of(cell)];
    return point == kNone ? nullptr : &points_[point];
  }
  std::size_t index_of(const Eigen::Array3i& cell) const {
    return static_cast<std::size_t>((cell.z() * size_.y() + cell.y()) * size_.x() + cell.x());
  }
  /// Asks the eight cells whose centres surround the place.
  const SurfacePoint* find_around(const Eigen::Vector3f& p_m, float distance_m) const;

  void add_patches(std::span<const SurfacePoint> surface);
  void add_facets(std::span<const SurfacePoint> patch);
  void fill_cells(double cell_m, double reach_m);

  std::vector<SurfacePoint> points_;
  std::vector<Patch> patches_;
  std::vector<Facet> facets_;
  Eigen::Vector3f origin_m_ = Eigen::Vector3f::Zero();  ///< the grid's lowest corner
  Eigen::Array3i size_ = Eigen::Array3i::Zero();
  float cells_per_m_ = 0;
  std::vector<std::uint32_t> nearest_;  ///< of each cell, x fastest
};

}  // namespace graspd::parts
