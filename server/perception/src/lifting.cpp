#include "graspd/perception/lifting.hpp"

#include <algorithm>
#include <cmath>

#include "column_kernel.hpp"
#include "kernel_pose.hpp"

namespace graspd::perception {
namespace {

constexpr int kColumnsAcross = 3;  // of an overlap that counts

}  // namespace

Lifting::Lifting(std::span<const PlacedPart> parts, const CollisionParameters& parameters)
    : column_m_(parameters.lift_overlap_m / kColumnsAcross),
      tolerance_m_(static_cast<float>(parameters.lift_tolerance_m)) {
  columns_.reserve(parts.size());
  for (const PlacedPart& part : parts) columns_.push_back(columns_of(part));
}

Lifting::Columns Lifting::columns_of(const PlacedPart& part) const {
  const Eigen::Vector3d centre_m = part.barycentre_m();
  const double reach_m = part.part->radius_m + column_m_;
  const auto column = [&](double p_m) { return static_cast<int>(std::floor(p_m / column_m_)); };
  Columns columns;
  columns.x_first = column(centre_m.x() - reach_m);
  columns.y_first = column(centre_m.y() - reach_m);
  columns.width = column(centre_m.x() + reach_m) - columns.x_first + 1;
  columns.height = column(centre_m.y() + reach_m) - columns.y_first + 1;
  const auto count =
      static_cast<std::size_t>(columns.width) * static_cast<std::size_t>(columns.height);
  columns.low_m.assign(count, kNone_m);
  columns.high_m.assign(count, -kNone_m);

  const parts::SphereArrays& points = part.part->contact.point_spheres();
  const KernelPose pose = kernel_pose(part.T_floor_part);
  const ColumnGrid grid{static_cast<float>(1 / column_m_), static_cast<float>(columns.x_first),
                        static_cast<float>(columns.y_first), columns.width, columns.height};
  PointColumns placed;
  for (std::size_t first = 0; first < points.size; first += PointColumns::kMost) {
    const std::size_t points_n = std::min(PointColumns::kMost, points.size - first);
    find_columns({&points.x_m[first], &points.y_m[first], &points.z_m[first], points_n}, pose, grid,
                 placed);
    for (std::size_t k = 0; k < points_n; ++k) {
      const auto i = static_cast<std::size_t>(placed.column[k]);
      // By value: std::min of what is in memory is a branch that nobody can predict.
      const float z_m = placed.z_m[k], low_m = columns.low_m[i], high_m = columns.high_m[i];
      columns.low_m[i] = z_m < low_m ? z_m : low_m;
      columns.high_m[i] = z_m > high_m ? z_m : high_m;
    }
  }
  columns.lowest_m = *std::ranges::min_element(columns.low_m);
  columns.highest_m = *std::ranges::max_element(columns.high_m);
  return columns;
}

std::optional<std::uint32_t> Lifting::in_the_way(std::size_t target) const {
  for (std::uint32_t other = 0; other < columns_.size(); ++other) {
    if (other != target && is_in_the_way(columns_[other], columns_[target])) return other;
  }
  return std::nullopt;
}

bool Lifting::is_in_the_way(const Columns& other, const Columns& lifted) const {
  if (other.highest_m <= lifted.lowest_m + tolerance_m_) return false;
  const int x_first = std::max(other.x_first, lifted.x_first);
  const int x_last = std::min(other.x_first + other.width, lifted.x_first + lifted.width) - 1;
  const int y_first = std::max(other.y_first, lifted.y_first);
  const int y_last = std::min(other.y_first + other.height, lifted.y_first + lifted.height) - 1;
  const auto above = [&](int x, int y) {
    const float low_m = lifted.low_m[lifted.index(x, y)];
    return low_m < kNone_m && other.high_m[other.index(x, y)] > low_m + tolerance_m_;
  };
  const auto block_above = [&](int x, int y) {
    for (int v = y; v < y + kColumnsAcross; ++v) {
      for (int u = x; u < x + kColumnsAcross; ++u) {
        if (!above(u, v)) return false;
      }
    }
    return true;
  };
  for (int y = y_first; y <= y_last - kColumnsAcross + 1; ++y) {
    for (int x = x_first; x <= x_last - kColumnsAcross + 1; ++x) {
      if (block_above(x, y)) return true;
    }
  }
  return false;
}

bool Lifting::meets_wall(std::size_t target, const Bin& bin) const {
  const Columns& columns = columns_[target];
  const Eigen::Array2d half_m = bin.inner_size_m.head<2>().array() / 2;
  // A wall of no thickness is still as thick as a column, or no column would find it.
  const double thickness_m = std::max(bin.wall_thickness_m, column_m_ + double{tolerance_m_});
  for (int y = columns.y_first; y < columns.y_first + columns.height; ++y) {
    for (int x = columns.x_first; x < columns.x_first + columns.width; ++x) {
      if (columns.low_m[columns.index(x, y)] >= static_cast<float>(bin.inner_size_m.z())) continue;
      const Eigen::Array2d p_m((x + 0.5) * column_m_, (y + 0.5) * column_m_);
      const double beyond_m = (p_m.abs() - half_m).maxCoeff();
      if (beyond_m > double{tolerance_m_} && beyond_m < thickness_m) return true;
    }
  }
  return false;
}

}  // namespace graspd::perception
