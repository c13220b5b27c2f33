#include "mesh_topology.hpp"

#include <algorithm>
#include <map>
#include <numeric>
#include <tuple>

#include "mesh_geometry.hpp"

namespace graspd::parts {
namespace {

// A triangle narrower than this has no direction that single precision could tell.
constexpr double kMinHeight_m = 1e-8;

struct EdgeUse {
  Edge edge;
  std::size_t triangle;
  bool forward;  ///< runs from the smaller index to the larger
};

struct Neighbour {
  std::size_t triangle;
  bool same_winding;
};

bool has_repeated_vertex(const std::array<int, 3>& t) {
  return t[0] == t[1] || t[1] == t[2] || t[2] == t[0];
}

bool has_no_area(const Mesh& mesh, const std::array<int, 3>& indices) {
  const Triangle triangle = triangle_of(mesh, indices);
  double longest_m = 0;
  for (std::size_t k = 0; k < 3; ++k) {
    longest_m =
        std::max(longest_m, (triangle.corners_m[(k + 1) % 3] - triangle.corners_m[k]).norm());
  }
  return triangle.area_vector_m2().norm() <= kMinHeight_m * longest_m;
}

/// Lists degenerate and duplicate triangles; returns those that make up the surface.
std::vector<std::size_t> sound_triangles(const Mesh& mesh, MeshTopology& topology) {
  std::vector<std::pair<std::array<int, 3>, std::size_t>> by_vertices;
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    std::array<int, 3> t = mesh.triangles[i];
    // One that has three vertices still joins its neighbours: only reported.
    if (has_no_area(mesh, t)) topology.degenerate_triangles.push_back(i);
    if (has_repeated_vertex(t)) continue;
    std::sort(t.begin(), t.end());
    by_vertices.emplace_back(t, i);
  }
  std::sort(by_vertices.begin(), by_vertices.end());
  std::vector<std::size_t> sound;
  for (std::size_t k = 0; k < by_vertices.size(); ++k) {
    const bool is_copy = k > 0 && by_vertices[k].first == by_vertices[k - 1].first;
    (is_copy ? topology.duplicate_triangles : sound).push_back(by_vertices[k].second);
  }
  return sound;
}

std::vector<EdgeUse> sorted_edge_uses(const Mesh& mesh, const std::vector<std::size_t>& sound) {
  std::vector<EdgeUse> uses;
  uses.reserve(3 * sound.size());
  for (const std::size_t i : sound) {
    const auto& t = mesh.triangles[i];
    for (std::size_t k = 0; k < 3; ++k) {
      const int from = t[k];
      const int to = t[(k + 1) % 3];
      uses.push_back({std::minmax(from, to), i, from < to});
    }
  }
  std::sort(uses.begin(), uses.end(), [](const EdgeUse& a, const EdgeUse& b) {
    return std::tie(a.edge, a.triangle) < std::tie(b.edge, b.triangle);
  });
  return uses;
}

/// Walks each surface from triangle to triangle and lists those wound against the majority.
std::vector<std::size_t> minority_winding(const std::vector<std::size_t>& sound,
                                          const std::vector<std::vector<Neighbour>>& neighbours) {
  enum class Winding : char { kUnknown, kAsFirst, kReversed };
  std::vector<Winding> winding(neighbours.size(), Winding::kUnknown);
  std::vector<std::size_t> reversed;
  for (const std::size_t first : sound) {
    if (winding[first] != Winding::kUnknown) continue;
    std::vector<std::size_t> surface{first};
    winding[first] = Winding::kAsFirst;
    for (std::size_t k = 0; k < surface.size(); ++k) {
      for (const Neighbour& next : neighbours[surface[k]]) {
        if (winding[next.triangle] != Winding::kUnknown) continue;
        const bool as_first = (winding[surface[k]] == Winding::kAsFirst) == next.same_winding;
        winding[next.triangle] = as_first ? Winding::kAsFirst : Winding::kReversed;
        surface.push_back(next.triangle);
      }
    }
    const auto as_first_n = std::count_if(surface.begin(), surface.end(), [&](std::size_t i) {
      return winding[i] == Winding::kAsFirst;
    });
    const Winding minority = 2 * static_cast<std::size_t>(as_first_n) >= surface.size()
                                 ? Winding::kReversed
                                 : Winding::kAsFirst;
    std::copy_if(surface.begin(), surface.end(), std::back_inserter(reversed),
                 [&](std::size_t i) { return winding[i] == minority; });
  }
  return reversed;
}

std::vector<std::size_t> count_pieces(const Mesh& mesh, const std::vector<std::size_t>& sound) {
  DisjointSets vertices(mesh.vertices_m.size());
  for (const std::size_t i : sound) {
    const auto& t = mesh.triangles[i];
    vertices.join(static_cast<std::size_t>(t[0]), static_cast<std::size_t>(t[1]));
    vertices.join(static_cast<std::size_t>(t[1]), static_cast<std::size_t>(t[2]));
  }
  std::map<std::size_t, std::size_t> triangles_n;
  for (const std::size_t i : sound) {
    ++triangles_n[vertices.find(static_cast<std::size_t>(mesh.triangles[i][0]))];
  }
  std::vector<std::size_t> pieces;
  pieces.reserve(triangles_n.size());
  for (const auto& [root, n] : triangles_n) pieces.push_back(n);
  std::sort(pieces.rbegin(), pieces.rend());
  return pieces;
}

}  // namespace

DisjointSets::DisjointSets(std::size_t size_n) : parent_(size_n) {
  std::iota(parent_.begin(), parent_.end(), std::size_t{0});
}

std::size_t DisjointSets::find(std::size_t i) {
  while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
  return i;
}

MeshTopology analyse_topology(const Mesh& mesh) {
  MeshTopology topology;
  const auto sound = sound_triangles(mesh, topology);
  const auto uses = sorted_edge_uses(mesh, sound);
  std::vector<std::vector<Neighbour>> neighbours(mesh.triangles.size());
  for (std::size_t begin = 0, end = 0; begin < uses.size(); begin = end) {
    const Edge& edge = uses[begin].edge;
    while (end < uses.size() && uses[end].edge == edge) ++end;
    if (end - begin == 1) {
      topology.boundary_edges.push_back(edge);
    } else if (end - begin > 2) {
      topology.non_manifold_edges.push_back(edge);
    } else {
      const bool same_winding = uses[begin].forward != uses[begin + 1].forward;
      if (!same_winding) topology.inconsistent_edges.push_back(edge);
      neighbours[uses[begin].triangle].push_back({uses[begin + 1].triangle, same_winding});
      neighbours[uses[begin + 1].triangle].push_back({uses[begin].triangle, same_winding});
    }
  }
  if (!topology.inconsistent_edges.empty()) {
    topology.reversed_triangles = minority_winding(sound, neighbours);
  }
  topology.triangles_of_piece = count_pieces(mesh, sound);
  return topology;
}

}  // namespace graspd::parts
