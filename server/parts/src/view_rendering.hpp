#pragma once

#include <vector>

#include "graspd/parts/mesh.hpp"

namespace graspd::parts {

struct RenderedView {
  std::vector<SurfacePoint> surface;
  /// Beside outlines, the part's and those of what lies before the rest of it, where the surface
  /// would go on if it did not end: a reading there says that what is seen is larger than the part.
  std::vector<SurfacePoint> beyond;
};

/// The surface points that a distant camera sees, one for each cell of a square grid across its
/// line of sight, row by row. Surfaces seen flatter than about 17° are left out: they send little
/// back, and a pixel's footprint covers much of them.
/// \param towards_camera unit. \param cell_m side of a cell. \param beyond_m from the outline.
RenderedView render_view(const Mesh& mesh, const Eigen::Vector3f& towards_camera, double cell_m,
                         double beyond_m);

}  // namespace graspd::parts
