#include "antipodal_pairs.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include "graspd/types/request.hpp"
#include "visit_surface.hpp"

namespace graspd::parts {
namespace {

constexpr double kContacts = 400;
constexpr int kMaxWalls = 4;           // that the line between two jaws may run through
constexpr double kPadGive_m = 0.0005;  // by which a pad follows the surface
constexpr double kMinPadShare = 0.3;
constexpr int kPadRays = 8;  // on each of two rings
constexpr double kAligned_rad = 0.02;

const double kFrictionAngle_rad = std::atan(kFriction);

struct Contact {
  Eigen::Vector3d position_m;
  Eigen::Vector3d normal;  ///< unit, outwards
};

Eigen::Vector3d normal_of(const Triangle& triangle) {
  return triangle.area_vector_m2().normalized();
}

double angle_rad(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  return std::acos(std::clamp(a.dot(b), -1.0, 1.0));
}

/// The share of a pad, pressed against a contact from outside, that touches; 0 where something
/// beside the contact holds the pad off.
double pad_share(const TriangleTree& tree, const Eigen::Vector3d& position_m,
                 const Eigen::Vector3d& outwards, double radius_m) {
  const double start_m = Gripper{}.clearance_m;
  const Eigen::Vector3d u = outwards.unitOrthogonal();
  const Eigen::Vector3d v = outwards.cross(u);
  int touching_n = 1;
  for (int k = 0; k < 2 * kPadRays; ++k) {
    const double angle = 2 * std::numbers::pi * k / kPadRays;
    const double r_m = k < kPadRays ? radius_m : radius_m / 2;
    const Eigen::Vector3d on_pad_m =
        position_m + r_m * (std::cos(angle) * u + std::sin(angle) * v) + start_m * outwards;
    const double depth_m = tree.first_hit(on_pad_m, -outwards).distance_m - start_m;
    if (depth_m < -kPadGive_m) return 0;
    touching_n += depth_m <= kPadGive_m ? 1 : 0;
  }
  return static_cast<double>(touching_n) / (1 + 2 * kPadRays);
}

class PairSearch {
 public:
  PairSearch(const TriangleTree& tree, double pad_radius_m)
      : tree_(tree), pad_radius_m_(pad_radius_m) {}

  void add_pairs_from(const Contact& first) { add_pairs_along(first, -first.normal, true); }

  std::vector<AntipodalPair> take() { return std::move(pairs_); }

 private:
  /// A jaw at the first contact, the other wherever the line leaves the solid again.
  void add_pairs_along(const Contact& first, const Eigen::Vector3d& line, bool may_turn) {
    double beyond_m = kItself_m;
    for (int wall = 0; wall < 2 * kMaxWalls; ++wall) {
      const auto hit = tree_.first_hit(first.position_m, line, beyond_m);
      if (hit.triangle == nullptr) return;
      beyond_m = hit.distance_m + kItself_m;
      const Contact second{first.position_m + hit.distance_m * line, normal_of(*hit.triangle)};
      const double off_rad = angle_rad(second.normal, line);
      if (may_turn && off_rad > kAligned_rad && off_rad < 2 * kFrictionAngle_rad) {
        // Faces that lean towards each other are pressed along what lies midway.
        add_pairs_along(first, (line + second.normal).normalized(), false);
      }
      if (off_rad <= kFrictionAngle_rad) add(first, second, line, hit.distance_m);
    }
  }

  void add(const Contact& first, const Contact& second, const Eigen::Vector3d& line,
           double width_m) {
    const double worse_rad =
        std::max(angle_rad(-first.normal, line), angle_rad(second.normal, line));
    if (worse_rad > kFrictionAngle_rad) return;
    const double share = std::min(pad_share(tree_, first.position_m, -line, pad_radius_m_),
                                  pad_share(tree_, second.position_m, line, pad_radius_m_));
    if (share < kMinPadShare) return;
    pairs_.push_back({0.5 * (first.position_m + second.position_m), line, width_m,
                      1 - worse_rad / kFrictionAngle_rad, share});
  }

  const TriangleTree& tree_;
  double pad_radius_m_;
  std::vector<AntipodalPair> pairs_;
};

}  // namespace

double pad_radius_m(double part_diameter_m) { return std::min(0.004, 0.08 * part_diameter_m); }

std::vector<AntipodalPair> antipodal_pairs(const Mesh& mesh, const TriangleTree& tree,
                                           double part_diameter_m) {
  PairSearch search(tree, pad_radius_m(part_diameter_m));
  visit_surface(mesh, kContacts / surface_area_m2(mesh), [&](const SurfacePoint& point) {
    search.add_pairs_from(
        {point.position_m.cast<double>(), point.normal.cast<double>().normalized()});
  });
  return search.take();
}

}  // namespace graspd::parts
