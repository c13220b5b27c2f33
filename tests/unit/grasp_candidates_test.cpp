#include "graspd/perception/grasp_candidates.hpp"

#include <gmock/gmock.h>

#include <filesystem>
#include <map>
#include <random>

#include "block_scene.hpp"
#include "random_pose.hpp"

namespace graspd::perception {
namespace {

using Eigen::Vector3d;
using ::testing::SizeIs;

constexpr int kPoses = 40;

/// One of the delivered parts.
const parts::Part& own_part(const std::string& id) {
  static std::map<std::string, parts::Part> loaded;
  if (!loaded.contains(id)) {
    const auto file =
        std::filesystem::path(GRASPD_SOURCE_DIR) / "deploy" / "parts" / id / "part.yaml";
    loaded[id] = parts::read_part_file(file).and_then(parts::make_part).value();
  }
  return loaded[id];
}

PlacedPart lying_anyhow(const parts::Part& part, std::mt19937& random) {
  PlacedPart placed{&part, Eigen::Isometry3d::Identity()};
  placed.T_floor_part.linear() = testing::random_rotation(random).toRotationMatrix();
  placed.T_floor_part.translation() = Vector3d(0.01, -0.02, 0.2);
  return placed;
}

PlacedPart lying_flat(const parts::Part& part) {
  PlacedPart placed{&part, Eigen::Isometry3d::Identity()};
  float lowest_m = 0;
  for (const auto& vertex_m : part.mesh.vertices_m) lowest_m = std::min(lowest_m, vertex_m.z());
  placed.T_floor_part.translation().z() = -static_cast<double>(lowest_m);
  return placed;
}

std::vector<GraspCandidate> candidates_of(const PlacedPart& part, const Gripper& gripper = {},
                                          const GraspParameters& parameters = {}) {
  return grasp_candidates(0, {&part, 1}, gripper, parameters);
}

Gripper cup(double diameter_m) {
  Gripper gripper;
  gripper.kind = GripperKind::kSuction;
  gripper.cup_diameter_m = diameter_m;
  return gripper;
}

GraspParameters all_tries() {
  GraspParameters parameters;
  parameters.tries_per_part_n = 1000;
  return parameters;
}

/// The angle about the closing direction from a pick point's approach to a candidate's, where the
/// candidate is one at this point.
std::optional<double> turn_at(const GraspCandidate& candidate, const PlacedPart& part,
                              const parts::PickPoint& point) {
  const Eigen::Isometry3d T_part_grasp = part.T_floor_part.inverse() * candidate.T_floor_grasp;
  const Vector3d approach = T_part_grasp.linear().col(2);
  const Vector3d from_point_m = T_part_grasp.translation() - point.position_m;
  const double reach_m = approach.dot(from_point_m);
  const bool is_at = candidate.pick_point == point.name &&
                     (from_point_m - reach_m * approach).norm() < 1e-9 && reach_m > -1e-9 &&
                     reach_m < point.tip_reach_m + 1e-9 &&
                     T_part_grasp.linear().col(0).dot(point.closing) > 1 - 1e-9;
  if (!is_at) return std::nullopt;
  return std::atan2(approach.dot(point.closing.cross(point.approach)),
                    approach.dot(point.approach));
}

const parts::PickPoint* pick_point_of(const GraspCandidate& candidate, const PlacedPart& part) {
  for (const auto& point : part.part->pick_points) {
    const auto turn_rad = turn_at(candidate, part, point);
    if (turn_rad && std::abs(*turn_rad) <= point.approach_cone_rad + 1e-6) return &point;
  }
  return nullptr;
}

class Candidates : public ::testing::TestWithParam<std::string> {
 protected:
  const parts::Part& part() const { return own_part(GetParam()); }
  std::mt19937 random_{11};
};

INSTANTIATE_TEST_SUITE_P(All, Candidates,
                         ::testing::Values("tee", "straight_pipe", "hex_bolt", "l_bracket",
                                           "flanged_ring"),
                         [](const auto& test) { return test.param; });

TEST_P(Candidates, AreRightHandedFramesAtPickPointsWithinTheirCones) {
  for (int i = 0; i < kPoses; ++i) {
    const PlacedPart placed = lying_anyhow(part(), random_);
    for (const GraspCandidate& candidate : candidates_of(placed)) {
      SCOPED_TRACE(candidate.pick_point);
      const Eigen::Matrix3d R = candidate.T_floor_grasp.linear();
      EXPECT_TRUE((R.transpose() * R).isIdentity(1e-9)) << "closing across approach";
      EXPECT_NEAR(R.determinant(), 1, 1e-9);
      if (candidate.pick_point == kPrincipalAxis) continue;
      const auto* point = pick_point_of(candidate, placed);
      ASSERT_NE(point, nullptr);
      EXPECT_EQ(candidate.width_m, point->width_m);
      EXPECT_NE(point->gripper, "suction");
    }
  }
}

TEST_P(Candidates, ComeFromAboveTheTaughtOnesAslantAtMost) {
  const GraspParameters parameters;
  for (int i = 0; i < kPoses; ++i) {
    const PlacedPart placed = lying_anyhow(part(), random_);
    for (const GraspCandidate& candidate : candidates_of(placed, {}, parameters)) {
      SCOPED_TRACE(candidate.pick_point);
      const auto* point = pick_point_of(candidate, placed);
      const bool is_taught = point != nullptr && !point->is_proposed;
      const double angle_rad = std::acos(-candidate.T_floor_grasp.linear()(2, 2));
      EXPECT_LE(angle_rad,
                (is_taught ? parameters.max_taught_tilt_rad : parameters.max_tilt_rad) + 1e-6);
    }
  }
}

TEST_P(Candidates, AreSortedBoundedAndNoneIsDouble) {
  for (const int most_n : {1, 5, 24}) {
    GraspParameters parameters;
    parameters.tries_per_part_n = most_n;
    const PlacedPart placed = lying_anyhow(part(), random_);
    const auto candidates = candidates_of(placed, {}, parameters);
    EXPECT_LE(candidates.size(), static_cast<std::size_t>(most_n));
    EXPECT_FALSE(candidates.empty());
    for (std::size_t i = 1; i < candidates.size(); ++i) {
      EXPECT_LE(candidates[i].preference, candidates[i - 1].preference);
      for (std::size_t j = 0; j < i; ++j) {
        const Eigen::Isometry3d T =
            candidates[i].T_floor_grasp.inverse() * candidates[j].T_floor_grasp;
        const bool is_double = T.translation().norm() < 1e-3 &&
                               std::abs(T.linear()(0, 0)) > 0.999 && T.linear()(2, 2) > 0.999;
        EXPECT_FALSE(is_double) << i << " and " << j;
      }
    }
  }
}

/// Each pick point that can be reached is, from as near to vertical as any turn within its cone.
TEST_P(Candidates, ComeAsNearToVerticalAsTheConeAllows) {
  const GraspParameters parameters = all_tries();
  const PlacedPart placed = lying_anyhow(part(), random_);
  const auto candidates = candidates_of(placed, {}, parameters);
  const Vector3d down = placed.T_floor_part.linear().transpose() * -Vector3d::UnitZ();
  int reached_n = 0;
  for (const auto& point : part().pick_points) {
    if (point.gripper == "suction") continue;
    double best = -1;
    const Vector3d aside = point.closing.cross(point.approach);
    for (int k = -2000; k <= 2000; ++k) {
      const double turn_rad = k / 2000.0 * point.approach_cone_rad;
      best = std::max(best,
                      down.dot(std::cos(turn_rad) * point.approach + std::sin(turn_rad) * aside));
    }
    const double limit_rad =
        point.is_proposed ? parameters.max_tilt_rad : parameters.max_taught_tilt_rad;
    if (std::abs(std::acos(best) - limit_rad) < 0.005) continue;  // the brute force is as coarse
    double reached = -1;
    for (const GraspCandidate& candidate : candidates) {
      if (turn_at(candidate, placed, point)) {
        reached = std::max(reached, -candidate.T_floor_grasp.linear()(2, 2));
      }
    }
    if (best < std::cos(limit_rad)) {
      EXPECT_EQ(reached, -1) << point.name;
    } else if (reached != -1) {  // else another one is the same grasp
      ++reached_n;
      EXPECT_NEAR(reached, best, 1e-4) << point.name;
    }
  }
  EXPECT_GT(reached_n, 3);
}

TEST_P(Candidates, OfATooNarrowOrTooWideStrokeIsTheOneThatMissesByLeast) {
  const PlacedPart placed = lying_anyhow(part(), random_);
  const auto all = candidates_of(placed, {}, all_tries());
  const auto [narrowest, widest] = std::minmax_element(
      all.begin(), all.end(), [](auto& a, auto& b) { return a.width_m < b.width_m; });
  Gripper narrow;
  narrow.max_opening_m = 0.001;
  const auto too_wide = candidates_of(placed, narrow);
  ASSERT_THAT(too_wide, SizeIs(1));
  EXPECT_NEAR(too_wide.front().width_m, narrowest->width_m, 1e-9);
  Gripper wide;
  wide.min_opening_m = 0.3;
  wide.max_opening_m = 0.4;
  const auto too_thin = candidates_of(placed, wide);
  ASSERT_THAT(too_thin, SizeIs(1));
  EXPECT_GE(too_thin.front().width_m, widest->width_m - 1e-9);
}

TEST_P(Candidates, OfACupStandOnPatchesAsWideAsItIs) {
  int found_n = 0;
  for (int i = 0; i < kPoses; ++i) {
    const PlacedPart placed = lying_anyhow(part(), random_);
    for (const GraspCandidate& candidate : candidates_of(placed, cup(0.006))) {
      ++found_n;
      const auto* point = pick_point_of(candidate, placed);
      ASSERT_NE(point, nullptr) << candidate.pick_point;
      EXPECT_EQ(point->gripper, "suction");
      EXPECT_GE(candidate.width_m, 0.006);
      EXPECT_GE(-candidate.T_floor_grasp.linear()(2, 2), std::cos(0.6) - 1e-6);
      EXPECT_NEAR(turn_at(candidate, placed, *point).value(), 0, 1e-9) << "along the normal";
    }
    EXPECT_THAT(candidates_of(placed, cup(0.5)), SizeIs(0));
  }
  EXPECT_GT(found_n, kPoses / 4);
}

TEST(GraspCandidates, TipsStayAboveTheFloorUnderAFlatPart) {
  // Across its width, the bracket's long leg is held 3 mm above the floor by pads of 8 mm.
  const PlacedPart placed = lying_flat(own_part("l_bracket"));
  int across_n = 0;
  for (const GraspCandidate& candidate : candidates_of(placed, {}, all_tries())) {
    const bool is_steep = candidate.T_floor_grasp.linear()(2, 2) < -0.999;
    if (!candidate.pick_point.starts_with("antipodal") || !is_steep) continue;
    ++across_n;
    EXPECT_GE(candidate.T_floor_grasp.translation().z(), 0.001 - 1e-9) << candidate.pick_point;
  }
  EXPECT_GT(across_n, 0);
}

TEST(GraspCandidates, PreferTaughtPointsThenProposedOnesThenThePrincipalAxis) {
  const PlacedPart placed = lying_flat(own_part("tee"));
  const auto candidates = candidates_of(placed);
  EXPECT_EQ(candidates.front().pick_point, "run");
  EXPECT_EQ(candidates.back().pick_point, kPrincipalAxis);
  GraspParameters parameters;
  parameters.principal_axis_priority = 10;
  EXPECT_EQ(candidates_of(placed, {}, parameters).front().pick_point, kPrincipalAxis);
}

TEST(GraspCandidates, ForACupLeaveOutThePrincipalAxis) {
  for (const auto& candidate : candidates_of(lying_flat(own_part("l_bracket")), cup(0.008))) {
    EXPECT_TRUE(candidate.pick_point.starts_with("flat_")) << candidate.pick_point;
  }
}

TEST(GraspCandidates, OfAPartWithoutPickPointsAreThePrincipalAxisTiltedEitherWay) {
  const parts::Part bar = testing::block_part("bar", {0.080, 0.020, 0.010});
  PlacedPart placed{&bar, Eigen::Isometry3d::Identity()};
  placed.T_floor_part.rotate(Eigen::AngleAxisd(0.4, Vector3d::UnitZ()));
  const auto candidates = candidates_of(placed);
  ASSERT_GT(candidates.size(), 8U);
  EXPECT_TRUE(candidates.front().T_floor_grasp.linear().col(2).isApprox(-Vector3d::UnitZ(), 1e-9));
  EXPECT_NEAR(candidates.front().width_m, 0.020, 1e-6);
  Vector3d sum = Vector3d::Zero();
  for (const GraspCandidate& candidate : candidates) {
    EXPECT_EQ(candidate.pick_point, kPrincipalAxis);
    sum += candidate.T_floor_grasp.linear().col(2);
  }
  EXPECT_LT(sum.head<2>().norm() / static_cast<double>(candidates.size()), 0.2);
}

}  // namespace
}  // namespace graspd::perception
