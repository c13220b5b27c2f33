#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

#include "graspd/parts/mesh.hpp"
#include "graspd/parts/pose_templates.hpp"
#include "graspd/parts/symmetries.hpp"

/// What registration looks up of a part, computed once when the catalogue loads.
namespace graspd::parts {

/// Unit vectors spread evenly over the sphere: the Fibonacci lattice.
std::vector<Eigen::Vector3f> spread_directions(int count);

/// Points with normals in separate arrays, for kernels that load many at once. Part frame, metres.
struct PointArrays {
  std::vector<float> x_m, y_m, z_m, nx, ny, nz;

  std::size_t size() const { return x_m.size(); }
  void push_back(const SurfacePoint& point);
  Eigen::Vector3f position_m(std::size_t i) const { return {x_m[i], y_m[i], z_m[i]}; }
  Eigen::Vector3f normal(std::size_t i) const { return {nx[i], ny[i], nz[i]}; }
};

/// What a distant camera sees of the part from one direction: points evenly spread in the image,
/// hidden ones left out. Any leading points are spread over the whole view, so that a test may stop
/// early.
struct View {
  Eigen::Vector3f towards_camera;  ///< unit
  std::uint32_t first = 0;         ///< of its points in RegistrationModel::points
  std::uint32_t points_n = 0;
  std::uint32_t beyond_first = 0;  ///< in RegistrationModel::beyond
  std::uint32_t beyond_n = 0;
  float area_share = 0;  ///< of the part's largest view
};

/// The part as cameras see it, from directions spread over the sphere.
class RegistrationModel {
 public:
  static constexpr std::size_t kSpreadPoints = 64;  ///< of a view: its leading ones, spread widest

  RegistrationModel() = default;
  RegistrationModel(const Mesh& mesh, const Symmetries& symmetries);

  /// Of all views, one after the other. Positions and normals are followed by 16 zeros, so that a
  /// kernel may load whole vectors.
  const PointArrays& points() const { return points_; }
  /// Of all views: places just beyond an outline, as deep as the surface beside them. A reading
  /// there says that what is seen goes on where the part ends.
  const PointArrays& beyond() const { return beyond_; }
  const std::vector<View>& views() const { return views_; }
  /// Across the line of sight, of the view that shows most.
  float largest_view_m2() const { return largest_view_m2_; }
  /// Where hypotheses come from.
  const PoseTemplates& templates() const { return templates_; }

  /// The view whose direction is nearest. \param towards_camera any length but 0.
  const View& view_from(const Eigen::Vector3f& towards_camera) const;

 private:
  void add_views(const Mesh& mesh, double diameter_m);

  PointArrays points_, beyond_;
  std::vector<View> views_;
  float largest_view_m2_ = 0;
  PoseTemplates templates_;
  std::vector<std::uint16_t> nearest_view_;  ///< of each cell of a cube map of directions
};

}  // namespace graspd::parts
