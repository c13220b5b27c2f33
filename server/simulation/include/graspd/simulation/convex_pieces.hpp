#pragma once

#include <Eigen/Geometry>
#include <vector>

#include "graspd/parts/mesh.hpp"

namespace graspd::simulation {

/// The convex hull of `vertices_m`, in the frame of the mesh.
struct ConvexPiece {
  std::vector<Eigen::Vector3d> vertices_m;
  double volume_m3 = 0;
};

/// When cutting ends: whichever comes first.
struct ConvexPiecesOptions {
  int max_pieces_n = 20;
  /// No further cut once the pieces' volume is within this share of the solid's.
  double max_excess = 0.05;
};

/// Convex pieces that together cover a solid, for physics. The solid is cut by planes across the
/// mesh's axes, each time where this removes most of the hulls' surplus volume, so that holes and
/// inner corners open up first. Works for any mesh; the finer the budget, the truer the holes.
/// The same mesh gives the same pieces.
std::vector<ConvexPiece> convex_pieces(const parts::Mesh& mesh,
                                       const ConvexPiecesOptions& options = {});

}  // namespace graspd::simulation
