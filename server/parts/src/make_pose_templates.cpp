#include "make_pose_templates.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace graspd::parts {
namespace {

/// Directions nearer to each other show the same: ICP comes from there. Half of the views are left.
constexpr double kSameView_rad = 14 * std::numbers::pi / 180;
constexpr std::size_t kMostAnchors = 8;  // of a view
constexpr float kAnchorSpacing = 0.18F;  // diameters
constexpr int kDeepInside_cells = 6;     // farther from the outline is all the same
constexpr float kNoDepth_m = std::numeric_limits<float>::max();

/// Whether a symmetry takes one direction to about the other.
bool look_alike(const Eigen::Vector3f& a, const Eigen::Vector3f& b, const Symmetries& symmetries) {
  const auto near = static_cast<float>(std::cos(kSameView_rad));
  const auto about_axis = [&](const Eigen::Vector3f& turned) {
    return std::any_of(
        symmetries.continuous.begin(), symmetries.continuous.end(),
        [&](const ContinuousSymmetry& symmetry) {
          const Eigen::Vector3f axis = symmetry.axis.cast<float>();
          const float along_a = turned.dot(axis), along_b = b.dot(axis);
          return along_a * along_b + turned.cross(axis).norm() * b.cross(axis).norm() > near;
        });
  };
  if (about_axis(a)) return true;
  return std::any_of(symmetries.discrete.begin(), symmetries.discrete.end(),
                     [&](const Eigen::Isometry3d& T) {
                       const Eigen::Vector3f turned = T.linear().cast<float>() * a;
                       return turned.dot(b) > near || about_axis(turned);
                     });
}

Eigen::Matrix3f view_axes(const Eigen::Vector3f& towards_camera) {
  const Eigen::Vector3f z = -towards_camera;
  const Eigen::Vector3f x = z.unitOrthogonal();
  Eigen::Matrix3f R_view_part;
  R_view_part << x.transpose(), z.cross(x).transpose(), z.transpose();
  return R_view_part;
}

/// Depths of a view over a square grid about its middle.
class DepthMap {
 public:
  DepthMap(const std::vector<Eigen::Vector3f>& points_m, double diameter_m, double cell_m)
      : cell_m_(static_cast<float>(cell_m)),
        // From an anchor at one end, the widest ring reaches beyond the other.
        half_(static_cast<int>(
                  std::ceil((0.5 + PoseTemplates::kRadii.back()) * diameter_m / cell_m)) +
              2),
        depths_m_(static_cast<std::size_t>(4 * half_ * half_), kNoDepth_m) {
    for (const Eigen::Vector3f& p : points_m)
      middle_m_ += p.head<2>() / static_cast<float>(points_m.size());
    for (const Eigen::Vector3f& p : points_m) {
      const auto [x, y] = cell_of(p.head<2>());
      // The points are a cell apart, but not in step with the map's: each covers four cells.
      for (int i = 0; i < 4; ++i) {
        if (!contains(x + i % 2, y + i / 2)) continue;
        float& depth_m = depths_m_[index(x + i % 2, y + i / 2)];
        depth_m = std::min(depth_m, p.z());
      }
    }
  }

  float at(const Eigen::Vector2f& p_m) const {
    const auto [x, y] = cell_of(p_m);
    return at(x, y);
  }

  /// Cells to the outline, up to `kDeepInside_cells`.
  int inside_cells(const Eigen::Vector2f& p_m) const {
    const auto [x, y] = cell_of(p_m);
    for (int reach = 1; reach < kDeepInside_cells; ++reach) {
      for (int i = -reach; i <= reach; ++i) {
        const bool is_outside =
            at(x + i, y - reach) == kNoDepth_m || at(x + i, y + reach) == kNoDepth_m ||
            at(x - reach, y + i) == kNoDepth_m || at(x + reach, y + i) == kNoDepth_m;
        if (is_outside) return reach;
      }
    }
    return kDeepInside_cells;
  }

 private:
  bool contains(int x, int y) const { return x >= 0 && y >= 0 && x < 2 * half_ && y < 2 * half_; }
  std::size_t index(int x, int y) const { return static_cast<std::size_t>(y * 2 * half_ + x); }
  float at(int x, int y) const { return contains(x, y) ? depths_m_[index(x, y)] : kNoDepth_m; }
  std::array<int, 2> cell_of(const Eigen::Vector2f& p_m) const {
    const Eigen::Vector2f cell = (p_m - middle_m_) / cell_m_;
    return {static_cast<int>(std::lround(cell.x())) + half_,
            static_cast<int>(std::lround(cell.y())) + half_};
  }

  Eigen::Vector2f middle_m_ = Eigen::Vector2f::Zero();
  float cell_m_;
  int half_;
  std::vector<float> depths_m_;
};

/// Points deep inside the outline first, where readings are sound; none too near to another.
std::vector<std::size_t> choose_anchors(const std::vector<Eigen::Vector3f>& points_m,
                                        const DepthMap& map, float spacing_m) {
  std::vector<std::pair<int, std::size_t>> order;
  for (std::size_t i = 0; i < points_m.size(); ++i) {
    order.emplace_back(-map.inside_cells(points_m[i].head<2>()), i);
  }
  std::sort(order.begin(), order.end());
  std::vector<std::size_t> chosen;
  for (const auto& [depth, i] : order) {
    if (chosen.size() == kMostAnchors) break;
    const bool is_far = std::all_of(chosen.begin(), chosen.end(), [&](std::size_t k) {
      return (points_m[i] - points_m[k]).head<2>().norm() > spacing_m;
    });
    if (is_far) chosen.push_back(i);
  }
  return chosen;
}

void add_samples(const Eigen::Vector3f& anchor_m, const DepthMap& map, float diameter_m,
                 PoseTemplates& templates) {
  std::uint64_t inside = 0;
  for (int i = 0; i < PoseTemplates::kSamples; ++i) {
    const int direction = i / PoseTemplates::kRings;
    const float angle_rad = 2 * std::numbers::pi_v<float> * static_cast<float>(direction) /
                            static_cast<float>(PoseTemplates::kTurns);
    const float radius_m =
        PoseTemplates::kRadii[static_cast<std::size_t>(i % PoseTemplates::kRings)] * diameter_m;
    const float depth_m = map.at(
        anchor_m.head<2>() + radius_m * Eigen::Vector2f(std::cos(angle_rad), std::sin(angle_rad)));
    if (depth_m != kNoDepth_m) inside |= std::uint64_t{1} << i;
    const float behind =
        depth_m == kNoDepth_m ? 0 : (depth_m - anchor_m.z()) / (PoseTemplates::kUnit * diameter_m);
    templates.depths.push_back(
        static_cast<std::int8_t>(std::clamp(std::lround(behind), -127L, 127L)));
  }
  templates.inside.push_back(inside);
}

}  // namespace

std::array<float, 3> PoseTemplates::polar(const Eigen::Vector3f& normal) {
  return {normal.head<2>().norm(), normal.z(),
          std::atan2(normal.y(), normal.x()) / (2 * std::numbers::pi_v<float>)*kTurns};
}

PoseTemplates make_pose_templates(std::span<const View> views, const PointArrays& points,
                                  double diameter_m, double cell_m, const Symmetries& symmetries) {
  PoseTemplates templates;
  std::vector<Eigen::Vector3f> kept;
  for (const View& view : views) {
    const bool known = std::any_of(kept.begin(), kept.end(), [&](const Eigen::Vector3f& other) {
      return look_alike(view.towards_camera, other, symmetries);
    });
    if (known) continue;
    kept.push_back(view.towards_camera);
    const Eigen::Matrix3f R_view_part = view_axes(view.towards_camera);
    std::vector<Eigen::Vector3f> seen_m;
    for (std::uint32_t i = 0; i < view.points_n; ++i) {
      seen_m.emplace_back(R_view_part * points.position_m(view.first + i));
    }
    const DepthMap map(seen_m, diameter_m, cell_m);
    for (const std::size_t i :
         choose_anchors(seen_m, map, kAnchorSpacing * static_cast<float>(diameter_m))) {
      const Eigen::Vector3f normal = R_view_part * points.normal(view.first + i);
      const auto [sine, cosine, turns] = PoseTemplates::polar(normal);
      templates.normal_sine.push_back(sine);
      templates.normal_cosine.push_back(cosine);
      templates.normal_turns.push_back(turns);
      templates.anchors_m.push_back(points.position_m(view.first + i));
      templates.views.push_back(static_cast<std::uint32_t>(templates.R_view_part.size()));
      add_samples(seen_m[i], map, static_cast<float>(diameter_m), templates);
    }
    templates.R_view_part.push_back(R_view_part);
  }
  for (auto* array : {&templates.normal_sine, &templates.normal_cosine, &templates.normal_turns}) {
    array->resize(array->size() + PoseTemplates::kReadAhead);
  }
  return templates;
}

}  // namespace graspd::parts
