#include "graspd/simulation/convex_pieces.hpp"

#include <LinearMath/btConvexHullComputer.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

// A piece is the solid within a box, kept as the surface polygons clipped to that box: their
// vertices span the piece's hull. (A corner of the box deep inside the solid is no such vertex;
// nothing can touch it there.) Which cut is best is found by trying: the cut that makes the two
// hulls' volumes smallest, over evenly spaced planes across each axis.
namespace graspd::simulation {
namespace {

using Polygon = std::vector<Eigen::Vector3d>;
using Polygons = std::vector<Polygon>;

constexpr int kCutsPerAxis = 15;
/// A cut must remove this share of the solid's volume.
constexpr double kLeastGain = 0.002;
/// Vertices closer than this share of the part's extent are one vertex to the physics.
constexpr double kMergeShare = 1.0 / 500;
constexpr double kToleranceShare = 1.0 / 200;
/// Finer meshes are thinned first, so that a scanned mesh costs no more than a drawn one.
constexpr std::size_t kMaxTriangles = 4000;
constexpr double kThinningShare = 1.0 / 60;

struct Plane {
  int axis = 0;
  double offset_m = 0;
};

Eigen::Vector3d to_eigen(const btVector3& v) { return {v.x(), v.y(), v.z()}; }

std::vector<Eigen::Vector3d> distinct_vertices(const Polygons& surface, double grid_m) {
  std::vector<std::array<long, 3>> cells;
  for (const Polygon& polygon : surface) {
    for (const Eigen::Vector3d& p : polygon) {
      cells.push_back(
          {std::lround(p.x() / grid_m), std::lround(p.y() / grid_m), std::lround(p.z() / grid_m)});
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

struct Face {
  Eigen::Vector3d normal;  ///< outwards
  double offset_m = 0;
};

struct Hull {
  std::vector<Eigen::Vector3d> vertices_m;
  std::vector<Face> faces;
  double volume_m3 = 0;
};

Hull hull_of(const std::vector<Eigen::Vector3d>& points_m) {
  Hull hull;
  if (points_m.size() < 4) return hull;
  btConvexHullComputer computer;
  computer.compute(points_m.front().data(), sizeof(Eigen::Vector3d), int(points_m.size()), 0, 0);
  for (int i = 0; i < computer.vertices.size(); ++i) {
    hull.vertices_m.push_back(to_eigen(computer.vertices[i]));
  }
  if (hull.vertices_m.size() < 4) return hull;

  const Eigen::Vector3d inside =
      std::accumulate(hull.vertices_m.begin(), hull.vertices_m.end(), Eigen::Vector3d(0, 0, 0)) /
      double(hull.vertices_m.size());
  for (int f = 0; f < computer.faces.size(); ++f) {
    const btConvexHullComputer::Edge* first = &computer.edges[computer.faces[f]];
    const Eigen::Vector3d a = hull.vertices_m[first->getSourceVertex()] - inside;
    Eigen::Vector3d area = Eigen::Vector3d::Zero();
    for (auto* edge = first->getNextEdgeOfFace(); edge != first; edge = edge->getNextEdgeOfFace()) {
      const Eigen::Vector3d b = hull.vertices_m[edge->getSourceVertex()] - inside;
      const Eigen::Vector3d c = hull.vertices_m[edge->getTargetVertex()] - inside;
      area += (b - a).cross(c - a) / 2;
    }
    if (area.dot(a) < 0) area = -area;
    hull.volume_m3 += area.dot(a) / 3;
    if (area.norm() > 0) {
      hull.faces.push_back({area.normalized(), area.normalized().dot(a + inside)});
    }
  }
  return hull;
}

double hull_volume_m3(const Polygons& surface, double grid_m) {
  return hull_of(distinct_vertices(surface, grid_m)).volume_m3;
}

/// The physics engine looks through a hull's vertices at every contact: the hull of few of them,
/// from which no other stands out by more than the tolerance.
Hull with_few_vertices(const Hull& full, double tolerance_m) {
  if (full.vertices_m.size() < 4) return full;
  std::vector<Eigen::Vector3d> chosen;
  for (const Eigen::Vector3d& direction :
       {Eigen::Vector3d(1, 1, 1), Eigen::Vector3d(1, -1, -1), Eigen::Vector3d(-1, 1, -1),
        Eigen::Vector3d(-1, -1, 1)}) {
    chosen.push_back(*std::max_element(
        full.vertices_m.begin(), full.vertices_m.end(),
        [&](const auto& p, const auto& q) { return p.dot(direction) < q.dot(direction); }));
  }
  while (true) {
    Hull hull = hull_of(chosen);
    double farthest_m = tolerance_m;
    const Eigen::Vector3d* farthest = nullptr;
    for (const Eigen::Vector3d& p : full.vertices_m) {
      // Of a flat or empty hull nothing is inside: take what is farthest from a chosen vertex.
      double outside_m = std::numeric_limits<double>::lowest();
      for (const Face& face : hull.faces) {
        outside_m = std::max(outside_m, face.normal.dot(p) - face.offset_m);
      }
      if (hull.volume_m3 <= 0) outside_m = (p - chosen.front()).norm();
      if (outside_m > farthest_m && std::find(chosen.begin(), chosen.end(), p) == chosen.end()) {
        farthest_m = outside_m;
        farthest = &p;
      }
    }
    if (farthest == nullptr) return hull;
    chosen.push_back(*farthest);
  }
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

/// One plane, or a cross of two: cutting a pipe lengthwise in two removes nothing of its hole's
/// hull, cutting it in four does.
using Cut = std::vector<Plane>;

std::vector<Polygons> cut_by(const Polygons& surface, const Cut& cut) {
  std::vector<Polygons> parts{surface};
  for (const Plane& plane : cut) {
    std::vector<Polygons> halves;
    for (const Polygons& part : parts) {
      halves.push_back(clip(part, plane, true));
      halves.push_back(clip(part, plane, false));
    }
    parts = std::move(halves);
  }
  return parts;
}

std::vector<Cut> possible_cuts(const Polygons& surface) {
  Eigen::AlignedBox3d box;
  for (const Polygon& polygon : surface) {
    for (const Eigen::Vector3d& p : polygon) box.extend(p);
  }
  const auto plane = [&](int axis, double share) {
    return Plane{axis, box.min()[axis] + share * box.sizes()[axis]};
  };
  std::vector<Cut> cuts;
  for (int axis = 0; axis < 3; ++axis) {
    for (int k = 1; k <= kCutsPerAxis; ++k) {
      cuts.push_back({plane(axis, double(k) / (kCutsPerAxis + 1))});
    }
    for (const double share_a : {0.25, 0.5, 0.75}) {
      for (const double share_b : {0.25, 0.5, 0.75}) {
        cuts.push_back({plane(axis, share_a), plane((axis + 1) % 3, share_b)});
      }
    }
  }
  return cuts;
}

struct Piece {
  Polygons surface;
  double hull_m3 = 0;
  Cut best_cut;
  double best_gain_m3 = 0;  ///< surplus removed for each piece that the cut adds
};

Piece make_piece(Polygons surface, double grid_m) {
  Piece piece;
  piece.hull_m3 = hull_volume_m3(surface, grid_m);
  for (Cut& cut : possible_cuts(surface)) {
    const std::vector<Polygons> parts = cut_by(surface, cut);
    double after_m3 = 0;
    for (const Polygons& part : parts) after_m3 += hull_volume_m3(part, grid_m);
    const double gain_m3 = (piece.hull_m3 - after_m3) / double(parts.size() - 1);
    if (gain_m3 > piece.best_gain_m3) {
      piece.best_gain_m3 = gain_m3;
      piece.best_cut = std::move(cut);
    }
  }
  piece.surface = std::move(surface);
  return piece;
}

Polygons surface_of(const parts::Mesh& mesh, double extent_m) {
  const double grid_m = mesh.triangles.size() > kMaxTriangles ? extent_m * kThinningShare : 0;
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
  const double tolerance_m = extent_m * kToleranceShare;
  const double solid_m3 = std::abs(parts::signed_volume_m3(mesh));

  std::vector<Piece> pieces;
  pieces.push_back(make_piece(surface_of(mesh, extent_m), grid_m));
  double hulls_m3 = pieces.front().hull_m3;
  while (int(pieces.size()) < options.max_pieces_n &&
         hulls_m3 > solid_m3 * (1 + options.max_excess)) {
    const auto worst = std::max_element(
        pieces.begin(), pieces.end(),
        [](const Piece& a, const Piece& b) { return a.best_gain_m3 < b.best_gain_m3; });
    if (worst->best_gain_m3 <= kLeastGain * solid_m3) break;
    const Piece whole = std::move(*worst);
    pieces.erase(worst);
    hulls_m3 -= whole.hull_m3;
    for (Polygons& part : cut_by(whole.surface, whole.best_cut)) {
      pieces.push_back(make_piece(std::move(part), grid_m));
      hulls_m3 += pieces.back().hull_m3;
    }
  }

  std::vector<ConvexPiece> hulls;
  for (const Piece& piece : pieces) {
    Hull hull = with_few_vertices(hull_of(distinct_vertices(piece.surface, grid_m)), tolerance_m);
    if (hull.volume_m3 > 0) hulls.push_back({std::move(hull.vertices_m), hull.volume_m3});
  }
  return hulls;
}

}  // namespace graspd::simulation
