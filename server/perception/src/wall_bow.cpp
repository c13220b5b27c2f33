#include "graspd/perception/wall_bow.hpp"

#include <Eigen/Dense>
#include <algorithm>

#include "parallel.hpp"

namespace graspd::perception {
namespace {

/// Poses that are asked, none nearer to another than this share of its diameter.
constexpr std::size_t kPoses = 24;
constexpr float kApartShare = 0.5F;
constexpr int kIcpSteps = 3;
/// A pose that fewer readings support says nothing.
constexpr int kFewestPoints = 30;
/// Weight of the expectation that the image is straight. A frame of bolts weighs 5, one of rings
/// 35: small parts say little, and on tuning frames that little was off by up to 3 mm.
constexpr double kExpected = 10;
constexpr double kDamping = 1e-4;  ///< of the number of points

/// The best poses, spread over the image.
std::vector<PoseHypothesis> spread_out(const PoseVerifier& verifier,
                                       std::span<const PoseHypothesis> poses) {
  std::vector<PoseHypothesis> chosen;
  for (const PoseHypothesis& pose : poses) {
    const bool is_apart = std::ranges::all_of(chosen, [&](const PoseHypothesis& other) {
      const auto least_m = kApartShare * static_cast<float>(verifier.part(other).diameter_m);
      return (verifier.barycentre_m(other) - verifier.barycentre_m(pose)).norm() > least_m;
    });
    if (!is_apart) continue;
    chosen.push_back(pose);
    if (chosen.size() == kPoses) break;
  }
  return chosen;
}

/// The normal equation a · bow = b of the bow alone.
struct BowEquation {
  double a = 0;
  double b_m = 0;
};

/// One part's, with the six unknowns of its pose eliminated (Schur complement).
BowEquation bow_equation(const DepthGrid& grid, const PoseVerifier& verifier,
                         const PoseHypothesis& pose, const BowedWalls& walls, float tolerance_m) {
  using Vector7 = Eigen::Matrix<double, 7, 1>;
  const parts::Part& part = verifier.part(pose);
  const parts::PointArrays& points = part.registration.points();
  const parts::View& seen = verifier.view(pose);
  const Eigen::Vector3f centre_m = verifier.barycentre_m(pose);
  const auto radius_m = static_cast<float>(part.diameter_m / 2);
  Eigen::Matrix<double, 7, 7> A = Eigen::Matrix<double, 7, 7>::Zero();
  Vector7 b = Vector7::Zero();
  int points_n = 0;
  for (std::uint32_t i = seen.first; i < seen.first + seen.points_n; ++i) {
    const Eigen::Vector3f p_m = pose.in_camera(points.position_m(i));
    const std::size_t cell = grid.cell_of(p_m);
    if (cell >= grid.z_m.size() || !grid.can_support(cell)) continue;
    const float error_m = grid.z_m[cell] - p_m.z();
    if (std::abs(error_m) > tolerance_m) continue;
    const Eigen::Vector3f n = pose.R * points.normal(i);
    const float along = n.dot(p_m) / p_m.z();  // of depth, along the normal
    const float distance_m = along * error_m;
    const float relative = distance_m / tolerance_m;
    const float root = std::max(0.0F, 1 - relative * relative);
    Vector7 J;
    J << (((p_m - centre_m) / radius_m).cross(n)).cast<double>(), n.cast<double>(),
        static_cast<double>(-along * walls.share_at(p_m * (grid.z_m[cell] / p_m.z())));
    const auto weight = static_cast<double>(root * root);
    A.noalias() += weight * J * J.transpose();
    b += weight * static_cast<double>(distance_m) * J;
    ++points_n;
  }
  if (points_n < kFewestPoints) return {};
  const auto pose_solver =
      (A.topLeftCorner<6, 6>() + kDamping * points_n * Eigen::Matrix<double, 6, 6>::Identity())
          .ldlt();
  const Eigen::Matrix<double, 6, 1> coupling = A.topRightCorner<6, 1>();
  return {A(6, 6) - coupling.dot(pose_solver.solve(coupling)),
          b[6] - coupling.dot(pose_solver.solve(b.head<6>()))};
}

}  // namespace

double find_wall_bow_m(const DepthGrid& grid, const PoseVerifier& verifier,
                       std::span<const PoseHypothesis> poses, const BowedWalls& walls) {
  const double tolerance_m = verifier.tolerance_m();
  std::vector<PoseHypothesis> asked = spread_out(verifier, poses);
  std::vector<BowEquation> equations(asked.size());
  parallel_for(asked.size(), [&](std::size_t i) {
    for (int k = 0; k < kIcpSteps; ++k) {
      verifier.icp_step(asked[i], PoseVerifier::kAllPoints, tolerance_m);
    }
    equations[i] = bow_equation(grid, verifier, asked[i], walls, static_cast<float>(tolerance_m));
  });
  BowEquation all;
  for (const BowEquation& part : equations) {
    all.a += part.a;
    all.b_m += part.b_m;
  }
  return all.b_m / (all.a + kExpected);
}

}  // namespace graspd::perception
