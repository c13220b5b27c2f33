#include "graspd/sim_cell/convex_pieces.hpp"

#include <LinearMath/btConvexHullComputer.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

// A piece is the solid within a box, kept as the surface polygons clipped to that box: their
// vertices span the piece's hull. (A corner of the box deep inside the solid is no such vertex;
// nothing can touch it there.) Which cut is best is found by trying: the cut that makes the two
// hulls' volumes smallest, over evenly spaced planes across each axis.
namespace graspd::sim_cell {
namespace {

using Polygon = std::vector<Eigen::Vector3d>;
using Polygons = std::vector<Polygon>;

constexpr int kCutsPerAxis = 15;
/// Vertices closer than this share of the part's extent are one vertex to the physics.
constexpr double kMergeShare = 1.0 / 250;
/// Finer meshes are thinned first, so that a scanned mesh costs no more than a drawn one.
constexpr std::size_t kMaxTriangles = 4000;
constexpr double kThinningShare = 1.0 / 60;

struct Plane {
  int axis = 0;
  double offset_m = 0;
};

struct Piece {
  Polygons surface;
  double hull_volume_m3 = 0;
  Plane best_cut;
  double best_gain_m3 = 0;
};

Eigen::Vector3d to_eigen(const btVector3& v) { return {v.x(), v.y(), v.z()}; }

std::vector<Eigen::Vector3d> distinct_vertices(const Polygons& surface, double grid_m) {
  std::vector<std::array<long, 3>> cells;
  for (const Polygon& polygon : surface) {
    for (const Eigen::Vector3d& p : polygon) {
      cells.push_back({std::lround(p.x() / grid_m), std::lround(p.y() / grid_m),
                       std::lround(p.z() / grid_m)});
    }
  }
  std::sort(cells.begin(), cells.end());
  cells.erase(std::unique(cells.begin(), cells.end()), cells.end());
  std::vector<Eigen::Vector3d> vertices;
  vertices.reserve(cells.size());
  for (const auto& [x, y, z] : cells) {
    vertices.emplace_back(grid_m * double(x), grid_m * double(y), grid_m * double(z));
  }
  return vertices;
}

ConvexPiece hull_of(const Polygons& surface, double grid_m) {
  ConvexPiece piece;
  // Bullet's hull works in floats and merges below their resolution: lengths in grid cells suit it.
  const std::vector<Eigen::Vector3d> vertices = distinct_vertices(surface, grid_m);
  if (vertices.size() < 4) return piece;
  btConvexHullComputer hull;
  hull.compute(vertices.front().data(), sizeof(Eigen::Vector3d), int(vertices.size()), 0, 0);
  for (int i = 0; i < hull.vertices.size(); ++i) {
    piece.vertices_m.push_back(to_eigen(hull.vertices[i]));
  }
  if (piece.vertices_m.size() < 4) return piece;

  const Eigen::Vector3d origin = piece.vertices_m.front();
  for (int f = 0; f < hull.faces.size(); ++f) {
    const btConvexHullComputer::Edge* first = &hull.edges[hull.faces[f]];
    const Eigen::Vector3d a = piece.vertices_m[first->getSourceVertex()] - origin;
    for (auto* edge = first->getNextEdgeOfFace(); edge != first; edge = edge->getNextEdgeOfFace()) {
      const Eigen::Vector3d b = piece.vertices_m[edge->getSourceVertex()] - origin;
      const Eigen::Vector3d c = piece.vertices_m[edge->getTargetVertex()] - origin;
      piece.volume_m3 += a.dot(b.cross(c)) / 6;
    }
  }
  piece.volume_m3 = std::abs(piece.volume_m3);
  return piece;
}

/// The polygons' parts below (or above) the plane.
Polygons clip(const Polygons& surface, Plane plane, bool keep_below) {
  const double sign = keep_below ? 1 : -1;
  Polygons kept;
  for (const Polygon& polygon : surface) {
    Polygon clipped;
    for (std::size_t i = 0; i < polygon.size(); ++i) {
      const Eigen::Vector3d& p = polygon[i];
      const Eigen::Vector3d& q = polygon[(i + 1) % polygon.size()];
      const double p_out = sign * (p[plane.axis] - plane.offset_m);
      const double q_out = sign * (q[plane.axis] - plane.offset_m);
      if (p_out <= 0) clipped.push_back(p);
      if (p_out * q_out < 0) clipped.push_back(p + (q - p) * (p_out / (p_out - q_out)));
    }
    if (clipped.size() >= 3) kept.push_back(std::move(clipped));
  }
  return kept;
}

Piece make_piece(Polygons surface, double grid_m) {
  Piece piece;
  piece.hull_volume_m3 = hull_of(surface, grid_m).volume_m3;
  for (int axis = 0; axis < 3; ++axis) {
    double low = std::numeric_limits<double>::max();
    double high = std::numeric_limits<double>::lowest();
    for (const Polygon& polygon : surface) {
      for (const Eigen::Vector3d& p : polygon) {
        low = std::min(low, p[axis]);
        high = std::max(high, p[axis]);
      }
    }
    for (int k = 1; k <= kCutsPerAxis; ++k) {
      const Plane cut{axis, low + (high - low) * k / (kCutsPerAxis + 1)};
      const double gain_m3 = piece.hull_volume_m3 -
                             hull_of(clip(surface, cut, true), grid_m).volume_m3 -
                             hull_of(clip(surface, cut, false), grid_m).volume_m3;
      if (gain_m3 > piece.best_gain_m3) {
        piece.best_gain_m3 = gain_m3;
        piece.best_cut = cut;
      }
    }
  }
  piece.surface = std::move(surface);
  return piece;
}

Polygons surface_of(const parts::Mesh& mesh, double extent_m) {
  const double grid_m =
      mesh.triangles.size() > kMaxTriangles ? extent_m * kThinningShare : 0;
  const auto vertex = [&](int index) -> Eigen::Vector3d {
    const Eigen::Vector3d p = mesh.vertices_m[std::size_t(index)].cast<double>();
    return grid_m > 0 ? Eigen::Vector3d((p / grid_m).array().round() * grid_m) : p;
  };
  Polygons surface;
  for (const auto& [a, b, c] : mesh.triangles) {
    Polygon triangle{vertex(a), vertex(b), vertex(c)};
    if ((triangle[1] - triangle[0]).cross(triangle[2] - triangle[0]).squaredNorm() > 0) {
      surface.push_back(std::move(triangle));
    }
  }
  return surface;
}

}  // namespace

std::vector<ConvexPiece> convex_pieces(const parts::Mesh& mesh,
                                       const ConvexPiecesOptions& options) {
  const double extent_m = parts::diameter_m(mesh);
  const double grid_m = extent_m * kMergeShare;
  const double solid_m3 = std::abs(parts::signed_volume_m3(mesh));

  std::vector<Piece> pieces;
  pieces.push_back(make_piece(surface_of(mesh, extent_m), grid_m));
  double hulls_m3 = pieces.front().hull_volume_m3;
  while (int(pieces.size()) < options.max_pieces_n &&
         hulls_m3 > solid_m3 * (1 + options.max_excess)) {
    const auto worst = std::max_element(
        pieces.begin(), pieces.end(),
        [](const Piece& a, const Piece& b) { return a.best_gain_m3 < b.best_gain_m3; });
    if (worst->best_gain_m3 <= 0) break;
    const Piece whole = std::move(*worst);
    hulls_m3 -= whole.best_gain_m3;
    *worst = make_piece(clip(whole.surface, whole.best_cut, true), grid_m);
    pieces.push_back(make_piece(clip(whole.surface, whole.best_cut, false), grid_m));
  }

  std::vector<ConvexPiece> hulls;
  for (const Piece& piece : pieces) {
    ConvexPiece hull = hull_of(piece.surface, grid_m);
    if (hull.vertices_m.size() >= 4) hulls.push_back(std::move(hull));
  }
  return hulls;
}

}  // namespace graspd::sim_cell
