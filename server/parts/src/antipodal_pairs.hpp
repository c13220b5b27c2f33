#pragma once

#include <Eigen/Core>
#include <vector>

#include "graspd/parts/mesh.hpp"
#include "triangle_tree.hpp"

namespace graspd::parts {

/// Two places on the surface that jaws may press towards each other: the line between them lies
/// within both friction cones, so that the grasp is in force closure (Nguyen 1988), and both give a
/// finger pad a surface rather than an edge or a point.
struct AntipodalPair {
  Eigen::Vector3d middle_m;
  Eigen::Vector3d closing;  ///< unit
  double width_m = 0;
  double friction_margin = 0;  ///< 1: along both normals; 0: on the edge of a friction cone
  double pad_share = 0;        ///< of the pads that touches, of the worse one
};

/// Of a finger pad on a dry machined part.
inline constexpr double kFriction = 0.4;

/// The pad that proposed grasps are held by: 8 mm across, less on parts below 50 mm.
double pad_radius_m(double part_diameter_m);

/// From points evenly over the surface.
std::vector<AntipodalPair> antipodal_pairs(const Mesh& mesh, const TriangleTree& tree,
                                           double part_diameter_m);

}  // namespace graspd::parts
