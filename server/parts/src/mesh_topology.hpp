#pragma once

#include <utility>
#include <vector>

#include "graspd/parts/mesh.hpp"

namespace graspd::parts {

using Edge = std::pair<int, int>;  ///< two vertices, the smaller index first

/// How the triangles of a mesh hang together. Triangles with a repeated vertex and copies of other
/// triangles are listed and then left out, so that one fault is reported once.
struct MeshTopology {
  std::vector<std::size_t> degenerate_triangles;  ///< without area
  std::vector<std::size_t> duplicate_triangles;   ///< each copy but the first
  std::vector<Edge> boundary_edges;               ///< of one triangle only
  std::vector<Edge> non_manifold_edges;           ///< of three triangles or more
  std::vector<Edge> inconsistent_edges;           ///< run in one direction by both triangles
  std::vector<std::size_t> reversed_triangles;    ///< wound against most of their piece
  std::vector<std::size_t> triangles_of_piece;    ///< how many, for each separate piece

  bool is_closed() const {
    return boundary_edges.empty() && non_manifold_edges.empty() && inconsistent_edges.empty();
  }
};

MeshTopology analyse_topology(const Mesh& mesh);

/// Sets of indices that were joined, directly or through others.
class DisjointSets {
 public:
  explicit DisjointSets(std::size_t size_n);
  std::size_t find(std::size_t i);
  void join(std::size_t i, std::size_t j) { parent_[find(i)] = find(j); }

 private:
  std::vector<std::size_t> parent_;
};

}  // namespace graspd::parts
