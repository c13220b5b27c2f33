#pragma once

#include <functional>

#include "graspd/parts/mesh.hpp"

namespace graspd::parts {

/// Visits points of a low-discrepancy sequence, equally dense all over the surface. Nothing is
/// random, so one mesh has the same points on every machine.
void visit_surface(const Mesh& mesh, double points_per_m2,
                   const std::function<void(const SurfacePoint&)>& visit);

}  // namespace graspd::parts
