#include "mesh_geometry.hpp"

#include <Eigen/Eigenvalues>
#include <cmath>

#include "mesh_topology.hpp"

namespace graspd::parts {
namespace {

/// Of the volume to the area to the power of 1.5, which is 0.09 for a ball and 0.002 for a plate of
/// 100 × 100 × 0.5 mm: less is a flat sheet with rounded coordinates.
constexpr double kSheetShare = 1e-5;

Eigen::Vector3d surface_centroid_m(const Mesh& mesh) {
  Eigen::Vector3d moment = Eigen::Vector3d::Zero();
  double area_m2 = 0;
  for (const auto& indices : mesh.triangles) {
    const Triangle triangle = triangle_of(mesh, indices);
    moment += triangle.area_m2() * triangle.centroid_m();
    area_m2 += triangle.area_m2();
  }
  return area_m2 > 0 ? Eigen::Vector3d(moment / area_m2) : Eigen::Vector3d::Zero();
}

/// Of the tetrahedron between a triangle and a reference point.
double tetrahedron_volume_m3(const Triangle& triangle, const Eigen::Vector3d& reference_m) {
  return triangle.area_vector_m2().dot(triangle.corners_m[0] - reference_m) / 6.0;
}

}  // namespace

Eigen::Vector3d with_fixed_sign(const Eigen::Vector3d& axis) {
  Eigen::Index largest = 0;
  axis.cwiseAbs().maxCoeff(&largest);
  return axis[largest] < 0 ? Eigen::Vector3d(-axis) : axis;
}

double surface_area_m2(const Mesh& mesh) {
  double area_m2 = 0;
  for (const auto& indices : mesh.triangles) area_m2 += triangle_of(mesh, indices).area_m2();
  return area_m2;
}

double signed_volume_m3(const Mesh& mesh) {
  // About a point of the mesh, so that a part far from its origin loses no digits.
  const Eigen::Vector3d reference_m = surface_centroid_m(mesh);
  double volume_m3 = 0;
  for (const auto& indices : mesh.triangles) {
    volume_m3 += tetrahedron_volume_m3(triangle_of(mesh, indices), reference_m);
  }
  return volume_m3;
}

bool is_inside_out(const Mesh& mesh) {
  return signed_volume_m3(mesh) < -kSheetShare * std::pow(surface_area_m2(mesh), 1.5);
}

Eigen::Vector3d barycentre_m(const Mesh& mesh) {
  Eigen::Vector3d surface_m = surface_centroid_m(mesh);
  if (!analyse_topology(mesh).is_closed()) return surface_m;
  Eigen::Vector3d moment = Eigen::Vector3d::Zero();
  double volume_m3 = 0;
  double absolute_m3 = 0;
  for (const auto& indices : mesh.triangles) {
    const Triangle triangle = triangle_of(mesh, indices);
    const double v = tetrahedron_volume_m3(triangle, surface_m);
    moment += v * (0.75 * triangle.centroid_m() + 0.25 * surface_m);
    volume_m3 += v;
    absolute_m3 += std::abs(v);
  }
  // A sheet closed upon itself encloses nothing.
  if (std::abs(volume_m3) < 1e-6 * absolute_m3 || absolute_m3 == 0) return surface_m;
  return moment / volume_m3;
}

Eigen::Matrix3d principal_axes(const Mesh& mesh) {
  const Eigen::Vector3d centroid_m = surface_centroid_m(mesh);
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  for (const auto& indices : mesh.triangles) {
    const Triangle triangle = triangle_of(mesh, indices);
    // ∫ x xᵀ dA over a triangle = A/12 · (Σ cᵢcᵢᵀ + 9 m mᵀ), cᵢ its corners and m their mean.
    const Eigen::Vector3d mean = triangle.centroid_m() - centroid_m;
    Eigen::Matrix3d second_moment = 9.0 * mean * mean.transpose();
    for (const Eigen::Vector3d& corner_m : triangle.corners_m) {
      second_moment += (corner_m - centroid_m) * (corner_m - centroid_m).transpose();
    }
    covariance += triangle.area_m2() / 12.0 * second_moment;
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(covariance);
  Eigen::Matrix3d axes;
  axes.col(0) = with_fixed_sign(solver.eigenvectors().col(2));
  axes.col(1) = with_fixed_sign(solver.eigenvectors().col(1));
  axes.col(2) = axes.col(0).cross(axes.col(1));
  return axes;
}

}  // namespace graspd::parts
