#include "view_rendering.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace graspd::parts {
namespace {

constexpr float kMinFacingCosine = 0.3F;
/// A surface that falls by this many times the distance has ended: steeper than 63°.
constexpr float kStep = 2;
constexpr float kNoHeight_m = std::numeric_limits<float>::lowest();

/// Depth buffer across the line of sight. Its axes: right, down, towards the camera.
class Canvas {
 public:
  Canvas(const Mesh& mesh, const Eigen::Vector3f& towards_camera, float cell_m, float margin_m)
      : cell_m_(cell_m), margin_(static_cast<int>(std::lround(margin_m / cell_m))) {
    axes_.col(2) = towards_camera;
    axes_.col(0) = towards_camera.unitOrthogonal();
    axes_.col(1) = towards_camera.cross(axes_.col(0));
    for (const auto& vertex : mesh.vertices_m) box_.extend(on_canvas(vertex).head<2>().eval());
    const Eigen::Vector2f margin_size =
        Eigen::Vector2f::Constant(static_cast<float>(margin_ + 1) * cell_m);
    box_ = Eigen::AlignedBox2f(box_.min() - margin_size, box_.max() + margin_size);
    const Eigen::Vector2f size = (box_.sizes() / cell_m).array().ceil();
    width_ = static_cast<int>(size.x()) + 1;
    height_ = static_cast<int>(size.y()) + 1;
    cells_.resize(static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_));
  }

  void draw(const Eigen::Vector3f& corner_a_m, const Eigen::Vector3f& corner_b_m,
            const Eigen::Vector3f& corner_c_m) {
    const Eigen::Vector3f normal =
        (corner_b_m - corner_a_m).cross(corner_c_m - corner_a_m).normalized();
    if (!(normal.dot(axes_.col(2)) > kMinFacingCosine)) return;
    const Eigen::Vector3f a = on_canvas(corner_a_m);
    const Eigen::Vector3f ab = on_canvas(corner_b_m) - a;
    const Eigen::Vector3f ac = on_canvas(corner_c_m) - a;
    Eigen::AlignedBox2f box(a.head<2>());
    box.extend((a + ab).head<2>().eval()).extend((a + ac).head<2>().eval());
    const float doubled_area = cross(ab, ac);
    for (int y = first_cell(box.min().y(), 1); y <= last_cell(box.max().y(), 1, height_); ++y) {
      for (int x = first_cell(box.min().x(), 0); x <= last_cell(box.max().x(), 0, width_); ++x) {
        const Eigen::Vector3f p = Eigen::Vector3f(centre(x, 0), centre(y, 1), 0) - a;
        const float along_b = cross(p, ac) / doubled_area;
        const float along_c = cross(ab, p) / doubled_area;
        if (along_b < 0 || along_c < 0 || along_b + along_c > 1) continue;
        const float height_m = a.z() + along_b * ab.z() + along_c * ac.z();
        Cell& cell = cells_[static_cast<std::size_t>(y * width_ + x)];
        if (height_m > cell.height_m) cell = {height_m, normal};
      }
    }
  }

  std::vector<SurfacePoint> points() const {
    std::vector<SurfacePoint> seen;
    for (int y = 0; y < height_; ++y) {
      for (int x = 0; x < width_; ++x) {
        if (at(x, y).height_m != kNoHeight_m) seen.push_back(point(x, y, at(x, y)));
      }
    }
    return seen;
  }

  /// Where a surface must have ended, since what is seen there lies `step_m` below it, or nothing:
  /// the cells whose nearest such surface is at the margin's distance, as high as that one.
  std::vector<SurfacePoint> beyond(float step_m) const {
    std::vector<SurfacePoint> rim;
    for (int y = 0; y < height_; ++y) {
      for (int x = 0; x < width_; ++x) {
        const float least_m =
            at(x, y).height_m == kNoHeight_m ? kNoHeight_m : at(x, y).height_m + step_m;
        int nearest2 = (margin_ + 1) * (margin_ + 1);
        const Cell* nearest = nullptr;
        for (int v = std::max(0, y - margin_); v <= std::min(height_ - 1, y + margin_); ++v) {
          for (int u = std::max(0, x - margin_); u <= std::min(width_ - 1, x + margin_); ++u) {
            const int distance2 = (u - x) * (u - x) + (v - y) * (v - y);
            const bool ends_here = at(u, v).height_m != kNoHeight_m && at(u, v).height_m >= least_m;
            if (!ends_here || distance2 >= nearest2) continue;
            nearest2 = distance2;
            nearest = &at(u, v);
          }
        }
        const bool is_there = nearest != nullptr && nearest2 > (margin_ - 1) * (margin_ - 1);
        if (is_there) rim.push_back(point(x, y, *nearest));
      }
    }
    return rim;
  }

 private:
  struct Cell {
    float height_m = kNoHeight_m;
    Eigen::Vector3f normal = Eigen::Vector3f::Zero();
  };

  const Cell& at(int x, int y) const { return cells_[static_cast<std::size_t>(y * width_ + x)]; }
  SurfacePoint point(int x, int y, const Cell& cell) const {
    return {axes_ * Eigen::Vector3f(centre(x, 0), centre(y, 1), cell.height_m), cell.normal};
  }
  Eigen::Vector3f on_canvas(const Eigen::Vector3f& p) const { return axes_.transpose() * p; }
  static float cross(const Eigen::Vector3f& a, const Eigen::Vector3f& b) {
    return a.x() * b.y() - a.y() * b.x();
  }
  float centre(int cell, int axis) const {
    return box_.min()[axis] + cell_m_ * static_cast<float>(cell);
  }
  int first_cell(float at_m, int axis) const {
    return std::max(0, static_cast<int>(std::ceil((at_m - box_.min()[axis]) / cell_m_)));
  }
  int last_cell(float at_m, int axis, int count) const {
    return std::min(count - 1, static_cast<int>(std::floor((at_m - box_.min()[axis]) / cell_m_)));
  }

  Eigen::Matrix3f axes_;
  float cell_m_;
  int margin_;
  Eigen::AlignedBox2f box_;
  int width_ = 0, height_ = 0;
  std::vector<Cell> cells_;
};

}  // namespace

RenderedView render_view(const Mesh& mesh, const Eigen::Vector3f& towards_camera, double cell_m,
                         double beyond_m) {
  Canvas canvas(mesh, towards_camera, static_cast<float>(cell_m), static_cast<float>(beyond_m));
  for (const auto& [a, b, c] : mesh.triangles) {
    canvas.draw(mesh.vertices_m[static_cast<std::size_t>(a)],
                mesh.vertices_m[static_cast<std::size_t>(b)],
                mesh.vertices_m[static_cast<std::size_t>(c)]);
  }
  return {canvas.points(), canvas.beyond(kStep * static_cast<float>(beyond_m))};
}

}  // namespace graspd::parts
