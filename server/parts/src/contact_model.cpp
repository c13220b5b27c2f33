#include "graspd/parts/contact_model.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

namespace graspd::parts {
namespace {

/// A cell is as wide as the template's points are apart; of large parts the grid is coarser.
constexpr double kCell_m = 0.002;
constexpr double kCellsAlong = 48;
constexpr float kSameFacetCosine = 0.7f;
constexpr double kPatch_m = 0.006;  ///< edge of the cube that a patch's points are in

}  // namespace

void SphereArrays::push_back(const Eigen::Vector3f& centre_m, float radius_of_it_m) {
  x_m.push_back(centre_m.x());
  y_m.push_back(centre_m.y());
  z_m.push_back(centre_m.z());
  radius_m.push_back(radius_of_it_m);
  ++size;
}

void SphereArrays::pad() {
  for (auto* values : {&x_m, &y_m, &z_m, &radius_m}) {
    values->resize(size + kPadding, size > 0 ? (*values)[size - 1] : 0);
  }
}

ContactModel::ContactModel(std::span<const SurfacePoint> surface) {
  if (surface.empty()) return;
  Eigen::Vector3f low_m = surface.front().position_m;
  Eigen::Vector3f high_m = low_m;
  for (const SurfacePoint& point : surface) {
    low_m = low_m.cwiseMin(point.position_m);
    high_m = high_m.cwiseMax(point.position_m);
  }
  const double cell_m = std::max(kCell_m, double{(high_m - low_m).maxCoeff()} / kCellsAlong);
  // Far enough that a patch which touches, of whatever part, never has its centre in an empty cell.
  const double half_diagonals_m = (kPatch_m + cell_m) * std::sqrt(3) / 2;
  const double reach_m = half_diagonals_m + kMaxDistance_m;
  const auto reach_cells = static_cast<int>(std::ceil(reach_m / cell_m));
  // A quarter aside, so that points in rows are not all on the cells' corners.
  grid_.origin_m = low_m.array() - static_cast<float>((reach_cells + 0.25) * cell_m);
  grid_.cells_per_m = static_cast<float>(1 / cell_m);
  grid_.size =
      ((high_m - low_m).array() * grid_.cells_per_m).floor().cast<int>() + 2 + 2 * reach_cells;
  add_patches(surface);
  for (const SurfacePoint& point : points_) point_spheres_.push_back(point.position_m, 0);
  for (const Patch& patch : patches_) patch_spheres_.push_back(patch.centre_m, patch.radius_m);
  point_spheres_.pad();
  patch_spheres_.pad();
  fill_cells(cell_m, reach_m);
}

void ContactModel::add_patches(std::span<const SurfacePoint> surface) {
  std::map<std::array<int, 3>, std::vector<std::uint32_t>> cells;
  for (std::uint32_t i = 0; i < surface.size(); ++i) {
    const Eigen::Array3i cell =
        (surface[i].position_m.cast<double>().array() / kPatch_m).floor().cast<int>();
    cells[{cell.x(), cell.y(), cell.z()}].push_back(i);
  }
  for (const auto& [cell, indices] : cells) {
    // In the middle of the cube, which bounds the radius.
    const Eigen::Array3d centre_m = (Eigen::Array3d(cell[0], cell[1], cell[2]) + 0.5) * kPatch_m;
    Patch patch{centre_m.cast<float>(), 0, static_cast<std::uint32_t>(points_.size()),
                static_cast<std::uint32_t>(indices.size())};
    for (const std::uint32_t i : indices) {
      points_.push_back(surface[i]);
      const float distance_m = (surface[i].position_m - patch.centre_m).norm();
      patch.radius_m = std::max(patch.radius_m, distance_m);
    }
    patches_.push_back(patch);
    add_facets(std::span(points_).subspan(patch.first, patch.points_n));
  }
}

void ContactModel::add_facets(std::span<const SurfacePoint> patch) {
  struct Group {
    Eigen::Vector3f first_normal, sum_m, normal_sum;
    int points_n;
  };
  std::vector<Group> groups;
  for (const SurfacePoint& point : patch) {
    const auto group = std::ranges::find_if(groups, [&](const Group& known) {
      return known.first_normal.dot(point.normal) > kSameFacetCosine;
    });
    if (group == groups.end()) {
      groups.push_back({point.normal, point.position_m, point.normal, 1});
    } else {
      group->sum_m += point.position_m;
      group->normal_sum += point.normal;
      ++group->points_n;
    }
  }
  for (const Group& group : groups) {
    facets_.push_back(
        {group.sum_m / static_cast<float>(group.points_n), group.normal_sum.normalized()});
  }
}

void ContactModel::fill_cells(double cell_m, double reach_m) {
  const auto cells_n = static_cast<std::size_t>(grid_.size.prod());
  nearest_.assign(cells_n, kNone);
  const auto reach2_m2 = static_cast<float>(reach_m * reach_m);
  std::vector<float> nearest2_m2(cells_n, reach2_m2);
  const auto half_m = static_cast<float>(cell_m / 2);
  const auto reach = static_cast<float>(reach_m);
  for (std::uint32_t k = 0; k < points_.size(); ++k) {
    const Eigen::Array3f p_m = (points_[k].position_m - grid_.origin_m).array();
    const Eigen::Array3i first = ((p_m - reach) * grid_.cells_per_m).cast<int>().max(0);
    const Eigen::Array3i last = ((p_m + reach) * grid_.cells_per_m).cast<int>().min(grid_.size - 1);
    for (int z = first.z(); z <= last.z(); ++z) {
      for (int y = first.y(); y <= last.y(); ++y) {
        for (int x = first.x(); x <= last.x(); ++x) {
          const Eigen::Array3f centre_m =
              Eigen::Array3f(float(x), float(y), float(z)) / grid_.cells_per_m + half_m;
          const float distance2_m2 = (centre_m - p_m).square().sum();
          const std::size_t i = index_of({x, y, z});
          if (distance2_m2 >= nearest2_m2[i]) continue;
          nearest2_m2[i] = distance2_m2;
          nearest_[i] = k;
        }
      }
    }
  }
  for (std::size_t i = 0; i < cells_n; ++i) {
    const bool is_far = nearest_[i] == kNone;
    grid_.distance_m.push_back(is_far ? DistanceGrid::kFar_m : std::sqrt(nearest2_m2[i]));
  }
}

const SurfacePoint* ContactModel::find_around(const Eigen::Vector3f& p_m, float distance_m) const {
  const Eigen::Array3i low = (in_cells(p_m) - 0.5f).floor().cast<int>();
  for (int corner = 0; corner < 8; ++corner) {
    const Eigen::Array3i step(corner & 1, corner >> 1 & 1, corner >> 2);
    const SurfacePoint* point = nearest_to(low + step);
    if (point != nullptr && (point->position_m - p_m).norm() <= distance_m) return point;
  }
  return nullptr;
}

}  // namespace graspd::parts
