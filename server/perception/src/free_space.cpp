#include "graspd/perception/free_space.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "kernel_pose.hpp"

namespace graspd::perception {
namespace {

constexpr float kNone_m = std::numeric_limits<float>::max();
constexpr int kTile = FreeDepth::kTile;
/// Beyond what was seen the image grows by at most this, for a bin that is partly out of view.
constexpr int kMostBeyond_px = 256;
/// Nearer to the camera than this, nothing projects to a sensible place.
constexpr double kNearest_m = 0.05;

/// How deep into the place of the part that is taken out its surroundings go on: as far as the
/// shadow of a part is wide that is 30 mm high, seen from 0.75 m under 30°. A jaw that needs more
/// is under the part.
constexpr int kShadow_px = 12;

// Of a cell.
constexpr std::uint8_t kClosed = 0;
constexpr std::uint8_t kOpen = 1;
constexpr std::uint8_t kOnRim = 2;  // open, and next

int whole_tiles(int px) { return (px + kTile - 1) / kTile * kTile; }

/// The part of a ray that is in a box, in multiples of its direction; none where first is beyond
/// last.
struct Stretch {
  double first = 0;
  double last = std::numeric_limits<double>::max();
};
Stretch stretch_in(const Eigen::Vector3d& origin_m, const Eigen::Vector3d& direction,
                   const Eigen::AlignedBox3d& box_m) {
  Stretch stretch;
  for (int axis = 0; axis < 3; ++axis) {
    const double a = (box_m.min()[axis] - origin_m[axis]) / direction[axis];
    const double b = (box_m.max()[axis] - origin_m[axis]) / direction[axis];
    stretch.first = std::max(stretch.first, std::min(a, b));
    stretch.last = std::min(stretch.last, std::max(a, b));
  }
  return stretch;
}

}  // namespace

FreeSpace::FreeSpace(const Scene& scene, std::span<const PlacedPart> parts,
                     const std::optional<Bin>& bin, const CollisionParameters& parameters)
    : parameters_(parameters), T_camera_floor_(scene.T_camera_floor) {
  place(*scene.seen, scene);
  // Before the walls are taken out: a hole at their edge is as deep as they are.
  fill_from_rim(parameters.hole_px);
  if (bin) take_out_walls(*bin, scene.workspace_m);
  keep_from_unexplained(parts, scene);
  fill_unseen(scene);
  find_tile_minima();
}

void FreeSpace::place(const DepthGrid& seen, const Scene& scene) {
  // The outermost cells of what was seen hold nothing, so that every open cell has eight around it.
  // Rays beyond them may yet meet parts.
  Eigen::AlignedBox2d area_px(Eigen::Vector2d(0, 0),
                              Eigen::Vector2d(seen.width_px - 1, seen.height_px - 1));
  const Eigen::AlignedBox2d most_px(area_px.min().array() - kMostBeyond_px,
                                    area_px.max().array() + kMostBeyond_px);
  for (int k = 0; k < 8; ++k) {
    const auto corner = static_cast<Eigen::AlignedBox3d::CornerType>(k);
    const Eigen::Vector3d p = scene.T_camera_floor * scene.workspace_m.corner(corner);
    if (p.z() < kNearest_m) continue;
    area_px.extend(Eigen::Vector2d(p.x() / p.z() * double{seen.fx_px} + double{seen.cx_px},
                                   p.y() / p.z() * double{seen.fy_px} + double{seen.cy_px}));
  }
  area_px = area_px.intersection(most_px);
  const auto left = static_cast<int>(std::floor(area_px.min().x()));
  const auto top = static_cast<int>(std::floor(area_px.min().y()));
  width_px_ = whole_tiles(static_cast<int>(std::ceil(area_px.max().x())) - left + 1);
  height_px_ = whole_tiles(static_cast<int>(std::ceil(area_px.max().y())) - top + 1);
  fx_px_ = seen.fx_px;
  fy_px_ = seen.fy_px;
  cx_px_ = seen.cx_px - static_cast<float>(left);
  cy_px_ = seen.cy_px - static_cast<float>(top);
  free_m_.assign(static_cast<std::size_t>(width_px_) * static_cast<std::size_t>(height_px_), 0);
  is_open_.assign(free_m_.size(), kClosed);
  covered_m_.resize(free_m_.size());
  for (int v = 1; v < seen.height_px - 1; ++v) {
    const std::size_t row = index(1 - left, v - top);
    std::copy_n(&seen.z_m[seen.index(1, v)], seen.width_px - 2, &free_m_[row]);
    for (std::size_t cell = row; cell < row + static_cast<std::size_t>(seen.width_px - 2); ++cell) {
      if (!(free_m_[cell] > 0)) open(cell);
    }
  }
}

Eigen::Vector3d FreeSpace::ray(int u, int v) const {
  return {double{(static_cast<float>(u) - cx_px_) / fx_px_},
          double{(static_cast<float>(v) - cy_px_) / fy_px_}, 1};
}

void FreeSpace::take_out_walls(const Bin& bin, const Eigen::AlignedBox3d& workspace_m) {
  const Eigen::Isometry3d T_floor_camera = T_camera_floor_.inverse();
  // What preprocessing takes for the wall's, on the wall's other side too.
  const Eigen::Array2d inner_m = workspace_m.sizes().head<2>().array() / 2;
  const Eigen::Array2d outer_m =
      bin.inner_size_m.head<2>().array() + bin.wall_thickness_m - inner_m;
  const double rim_m = bin.inner_size_m.z() + parameters_.cloud_tolerance_m;
  for (int v = 0; v < height_px_; ++v) {
    for (int u = 0; u < width_px_; ++u) {
      float& free_m = free_m_[index(u, v)];
      if (free_m <= 0) continue;
      const Eigen::Vector3d direction = T_floor_camera.linear() * ray(u, v);
      const Eigen::Vector3d p_m = T_floor_camera.translation() + direction * double{free_m};
      const Eigen::Array2d aside_m = p_m.head<2>().array().abs();
      const bool is_wall =
          (aside_m > inner_m).any() && (aside_m < outer_m).all() && p_m.z() < rim_m;
      if (!is_wall) continue;
      const Stretch inside = stretch_in(T_floor_camera.translation(), direction, workspace_m);
      const bool hides_something = inside.first < inside.last && inside.last > double{free_m};
      if (!hides_something) free_m = kNone_m;
    }
  }
}

void FreeSpace::fill_unseen(const Scene& scene) {
  const Eigen::Isometry3d T_floor_camera = T_camera_floor_.inverse();
  for (int v = 0; v < height_px_; ++v) {
    for (int u = 0; u < width_px_; ++u) {
      float& free_m = free_m_[index(u, v)];
      if (free_m > 0) continue;
      const Stretch inside = stretch_in(T_floor_camera.translation(),
                                        T_floor_camera.linear() * ray(u, v), scene.workspace_m);
      free_m = inside.first < inside.last ? static_cast<float>(inside.first) : kNone_m;
    }
  }
}

std::vector<FreeSpace::Cell> FreeSpace::unexplained(std::span<const PlacedPart> parts,
                                                    const Scene& scene) {
  const auto tolerance_m = static_cast<float>(parameters_.cloud_tolerance_m);
  const Eigen::Isometry3f T_floor_camera = T_camera_floor_.inverse().cast<float>();
  const Eigen::AlignedBox3f workspace_m = scene.workspace_m.cast<float>();
  std::vector<std::uint8_t> is_unexplained(free_m_.size(), 0);
  const Eigen::Vector3f next = T_floor_camera.linear().col(0) / fx_px_;  // ray, one column on
  for (int v = 0; v < height_px_; ++v) {
    const Eigen::Vector3f first = T_floor_camera.linear() * ray(0, v).cast<float>();
    for (int u = 0; u < width_px_; ++u) {
      const float free_m = free_m_[index(u, v)];
      if (!(free_m > 0) || free_m == kNone_m) continue;
      const Eigen::Vector3f p_m =
          T_floor_camera.translation() + (first + static_cast<float>(u) * next) * free_m;
      is_unexplained[index(u, v)] = p_m.z() > tolerance_m && workspace_m.contains(p_m) ? 1 : 0;
    }
  }
  for (const PlacedPart& part : parts) {
    for_cells_of(part, [&](std::size_t cell) { is_unexplained[cell] = 0; });
  }
  std::vector<Cell> cells;
  for (std::size_t cell = 0; cell < free_m_.size(); ++cell) {
    if (is_unexplained[cell] != 0) cells.push_back({cell, free_m_[cell]});
  }
  return cells;
}

void FreeSpace::keep_from_unexplained(std::span<const PlacedPart> parts, const Scene& scene) {
  // All of the image has `cloud_tolerance_m`: what has less comes nearer by the difference.
  const auto nearer_m =
      static_cast<float>(parameters_.cloud_tolerance_m - parameters_.unexplained_tolerance_m);
  const int reach_px = parameters_.edge_px;
  for (const auto& [cell, free_m] : unexplained(parts, scene)) {
    const auto u = static_cast<int>(cell % static_cast<std::size_t>(width_px_));
    const auto v = static_cast<int>(cell / static_cast<std::size_t>(width_px_));
    for (int y = std::max(0, v - reach_px); y <= std::min(height_px_ - 1, v + reach_px); ++y) {
      for (int x = std::max(0, u - reach_px); x <= std::min(width_px_ - 1, u + reach_px); ++x) {
        float& there_m = free_m_[index(x, y)];
        there_m = std::min(there_m, free_m - nearer_m);
      }
    }
  }
}

void FreeSpace::find_tile_minima() {
  const int tiles_u = width_px_ / kTile;
  tile_free_m_.assign(static_cast<std::size_t>(tiles_u) * (height_px_ / kTile), kNone_m);
  for (int v = 0; v < height_px_; ++v) {
    for (int u = 0; u < width_px_; ++u) {
      float& least_m = tile_free_m_[static_cast<std::size_t>(v / kTile) * tiles_u + u / kTile];
      least_m = std::min(least_m, free_m_[index(u, v)]);
    }
  }
}

void FreeSpace::open(std::size_t cell) {
  covered_m_[cell] = free_m_[cell];
  free_m_[cell] = kNone_m;
  is_open_[cell] = kOpen;
  open_.push_back(cell);
}

void FreeSpace::fill_from_rim(int steps_n) {
  const std::ptrdiff_t row = width_px_;
  const std::ptrdiff_t around[] = {-row - 1, -row, -row + 1, -1, 1, row - 1, row, row + 1};
  const auto beside = [&](std::size_t cell, std::ptrdiff_t offset) {
    return cell + static_cast<std::size_t>(offset);
  };
  const auto nearest_beside_m = [&](std::size_t cell) {
    float nearest_m = kNone_m;
    for (const float* at_m : {&free_m_[cell] - row, &free_m_[cell], &free_m_[cell] + row}) {
      // Without a branch: open cells, as this one, hold kNone_m.
      for (int u = -1; u <= 1; ++u) {
        nearest_m = std::min(nearest_m, at_m[u] > 0 ? at_m[u] : kNone_m);
      }
    }
    return nearest_m;
  };
  rim_.clear();
  for (const std::size_t cell : open_) {
    if (nearest_beside_m(cell) < kNone_m) rim_.push_back(cell);
  }
  for (int step = 0; step < steps_n && !rim_.empty(); ++step) {
    filled_.clear();
    for (const std::size_t cell : rim_) filled_.push_back({cell, nearest_beside_m(cell)});
    for (const auto& [cell, value] : filled_) {
      // Without the part the ray sees at least as far as with it.
      free_m_[cell] = std::max(covered_m_[cell], value);
      is_open_[cell] = kClosed;
    }
    // Every neighbour is written down and only open ones are counted: a branch would be a guess.
    rim_.resize(open_.size() + 1);
    std::size_t rim_n = 0;
    for (const Cell& filled : filled_) {
      for (const std::ptrdiff_t offset : around) {
        const std::size_t other = beside(filled.index, offset);
        const bool is_open = is_open_[other] == kOpen;
        rim_[rim_n] = other;
        rim_n += is_open ? 1 : 0;
        is_open_[other] = is_open ? kOnRim : is_open_[other];
      }
    }
    rim_.resize(rim_n);
  }
  for (const std::size_t cell : open_) {
    if (is_open_[cell] == kClosed) continue;
    free_m_[cell] = covered_m_[cell];
    is_open_[cell] = kClosed;
  }
  open_.clear();
}

template <class See>
void FreeSpace::for_cells_of(const PlacedPart& part, const See& see) {
  // The template's points are about a pixel apart; one more pixel around each closes the gaps.
  draw_silhouette(part, T_camera_floor_, {width_px_, height_px_, fx_px_, fy_px_, cx_px_, cy_px_},
                  parameters_.edge_px + 1, silhouette_);
  const auto tolerance_m = static_cast<float>(parameters_.cloud_tolerance_m);
  for (int y = 0; y < silhouette_.height; ++y) {
    const float* nearest_m = silhouette_.row(y);
    const std::size_t first = index(silhouette_.u_first, silhouette_.v_first + y);
    for (int x = 0; x < silhouette_.width; ++x) {
      const std::size_t cell = first + static_cast<std::size_t>(x);
      if (nearest_m[x] == Silhouette::kNone_m || free_m_[cell] < nearest_m[x] - tolerance_m)
        continue;
      see(cell);
    }
  }
}

void FreeSpace::take_out(const PlacedPart& target) {
  for (const auto& [cell, value] : taken_) free_m_[cell] = value;
  taken_.clear();
  for_cells_of(target, [this](std::size_t cell) {
    taken_.push_back({cell, free_m_[cell]});
    open(cell);
  });
  fill_from_rim(kShadow_px);
}

bool FreeSpace::is_free(const Eigen::AlignedBox3d& box_grasp_m,
                        const Eigen::Isometry3d& T_floor_grasp) const {
  const Eigen::Isometry3d T_camera_grasp = T_camera_floor_ * T_floor_grasp;
  Eigen::AlignedBox2d area_px;
  double deepest_m = 0;
  for (int k = 0; k < 8; ++k) {
    const auto corner = static_cast<Eigen::AlignedBox3d::CornerType>(k);
    Eigen::Vector3d p = T_camera_grasp * box_grasp_m.corner(corner);
    deepest_m = std::max(deepest_m, p.z());
    p.z() = std::max(p.z(), kNearest_m);
    area_px.extend(Eigen::Vector2d(p.x() / p.z() * double{fx_px_} + double{cx_px_},
                                   p.y() / p.z() * double{fy_px_} + double{cy_px_}));
  }
  const auto tile = [](double px, int most_px) {
    return static_cast<int>(std::clamp(px, 0.0, static_cast<double>(most_px))) / kTile;
  };
  const TileBox tiles{tile(std::floor(area_px.min().x()), width_px_),
                      tile(std::floor(area_px.min().y()), height_px_),
                      tile(std::ceil(area_px.max().x()) + kTile, width_px_),
                      tile(std::ceil(area_px.max().y()) + kTile, height_px_)};
  Eigen::Isometry3d T_camera_box = T_camera_grasp;
  T_camera_box.translate(box_grasp_m.center());
  const Eigen::Vector3f half_m = (box_grasp_m.sizes() / 2).cast<float>();
  return !meets_unseen(for_kernel(), {{half_m.x(), half_m.y(), half_m.z()}},
                       kernel_pose(T_camera_box.inverse()), tiles, static_cast<float>(deepest_m),
                       static_cast<float>(parameters_.cloud_tolerance_m));
}

FreeDepth FreeSpace::for_kernel() const {
  return {free_m_.data(), tile_free_m_.data(), width_px_, height_px_, fx_px_, fy_px_, cx_px_,
          cy_px_};
}

}  // namespace graspd::perception
