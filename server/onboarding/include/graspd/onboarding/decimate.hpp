#pragma once

#include <cstddef>

#include "graspd/parts/mesh.hpp"

namespace graspd::onboarding {

/// Above this many triangles a mesh is decimated, to this many: on a part as large as a hand they
/// are smaller than a pixel of a Kinect v2, and each costs time in every rendering.
inline constexpr std::size_t kMaxTriangles = 100'000;
inline constexpr std::size_t kDecimatedTriangles = 20'000;

/// A mesh of fewer triangles.
struct Decimated {
  parts::Mesh mesh;
  double error_m = 0;  ///< by about which the surface has moved, at its worst
};

/// Quadric edge collapse (Garland and Heckbert 1997). Ends before `triangles_n` where the surface
/// would move by more than a thousandth of the mesh's longest side.
Decimated decimate(const parts::Mesh& mesh, std::size_t triangles_n = kDecimatedTriangles);

}  // namespace graspd::onboarding
