/// The equations of the paper's section III-D with numbers worked out by hand.
#include "graspd/perception/grs.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "random_pile.hpp"

namespace graspd::perception {
namespace {

using Eigen::Vector3d;

using testing::placed;

TEST(PSelf, IsTheWeightedSumOfHeightAndSine) {
  GrsParameters parameters;
  parameters.k1 = 5;
  parameters.k2 = 0.1;
  // 5 · 0.06 + 0.1 · sin 30° = 0.30 + 0.05
  EXPECT_NEAR(p_self(0.06, M_PI / 6, parameters), 0.35, 1e-12);
  EXPECT_NEAR(p_self(0, 0, parameters), 0, 1e-12);
  EXPECT_NEAR(p_self(0, M_PI / 2, parameters), 0.1, 1e-12);
}

TEST(Inclination, IsMeasuredFromTheHorizontalPlaneEitherWay) {
  EXPECT_NEAR(inclination_rad(Vector3d(1, 0, 0)), 0, 1e-12);
  EXPECT_NEAR(inclination_rad(Vector3d(0, 0, -2)), M_PI / 2, 1e-12);
  EXPECT_NEAR(inclination_rad(Vector3d(std::sqrt(3.0), 0, 1)), M_PI / 6, 1e-12);
  EXPECT_NEAR(inclination_rad(Vector3d(-std::sqrt(3.0), 0, -1)), M_PI / 6, 1e-12);
}

TEST(PGrasp, IsTheMeanSquaredDistanceToTheKNearest) {
  GrsParameters parameters;
  parameters.neighbours_n = 2;
  const std::vector<Vector3d> centroids_m = {{0, 0, 0}, {0.3, 0, 0}, {0, 0.1, 0}, {0.1, 0.1, 0.1}};
  const PGrasp result = p_grasp(0, centroids_m, parameters);
  // Nearest: #2 at 0.1 (0.01), #3 at √0.03 (0.03). Mean 0.02.
  EXPECT_NEAR(result.value_m2, 0.02, 1e-12);
  EXPECT_EQ(result.neighbours, (std::vector<std::uint32_t>{2, 3}));
}

TEST(PGrasp, CountsMissingNeighboursAsIsolated) {
  GrsParameters parameters;
  parameters.neighbours_n = 4;
  parameters.isolation_distance_m = 0.2;
  const std::vector<Vector3d> centroids_m = {{0, 0, 0}, {0.1, 0, 0}};
  // (0.01 + 3 · 0.04) / 4
  EXPECT_NEAR(p_grasp(0, centroids_m, parameters).value_m2, 0.0325, 1e-12);
  EXPECT_NEAR(p_grasp(0, {centroids_m.data(), 1}, parameters).value_m2, 0.04, 1e-12);
}

std::uint32_t search_shared_points(std::size_t target, const std::vector<PlacedPart>& pile,
                                   double distance_m) {
  const auto is_near_another = [&](const Vector3d& p_m) {
    for (std::size_t other = 0; other < pile.size(); ++other) {
      if (other == target) continue;
      for (const auto& point : pile[other].part->surface) {
        const Vector3d q_m = pile[other].T_floor_part * point.position_m.cast<double>();
        if ((p_m - q_m).norm() <= distance_m) return true;
      }
    }
    return false;
  };
  return static_cast<std::uint32_t>(
      std::ranges::count_if(pile[target].part->surface, [&](const parts::SurfacePoint& point) {
        return is_near_another(pile[target].T_floor_part * point.position_m.cast<double>());
      }));
}

/// Bricks of 20 × 10 × 10 mm with template points 5 mm apart, so that shared points can be counted
/// by hand: the top face has 5 × 3 points.
class PSystemByCount : public ::testing::Test {
 protected:
  parts::Part brick_ = testing::block_part("brick", {0.020, 0.010, 0.010}, 0.005);
  GrsParameters parameters_ = [] {
    GrsParameters parameters;
    parameters.overlap_distance_m = 0.001;
    parameters.overlap_threshold_n = 15;
    return parameters;
  }();
};

TEST_F(PSystemByCount, CountsTheTemplatePointsThatCoincide) {
  // Each face of the template has its own points on the edges it shares: the count of template
  // points with z = +5 mm, on the top face and on the upper edges of the four sides.
  std::uint32_t top_n = 0;
  for (const auto& point : brick_.surface) top_n += point.position_m.z() > 0.0049f;
  ASSERT_EQ(top_n, 5U * 3 + 2 * 5 + 2 * 3);

  const std::vector<PlacedPart> stack = {placed(brick_, {0, 0, 0.005}),
                                         placed(brick_, {0, 0, 0.0155})};
  const PSystemCount count = p_system_count(0, stack, parameters_);
  EXPECT_EQ(count.points_n, top_n);
  EXPECT_EQ(count.others, std::vector<std::uint32_t>{1});
  EXPECT_EQ(count.value, 0);
}

TEST_F(PSystemByCount, IsZeroOnlyAboveTheThreshold) {
  const std::vector<PlacedPart> stack = {placed(brick_, {0, 0, 0.005}),
                                         placed(brick_, {0, 0, 0.0155})};
  parameters_.overlap_threshold_n = 31;  // threshold ≥ count: 1
  EXPECT_EQ(p_system_count(0, stack, parameters_).value, 1);
  parameters_.overlap_threshold_n = 30;  // threshold < count: 0
  EXPECT_EQ(p_system_count(0, stack, parameters_).value, 0);
}

TEST_F(PSystemByCount, IsOneForPartsApart) {
  const std::vector<PlacedPart> apart = {placed(brick_, {0, 0, 0.005}),
                                         placed(brick_, {0, 0.012, 0.005})};
  const PSystemCount count = p_system_count(0, apart, parameters_);
  EXPECT_EQ(count.points_n, 0U);
  EXPECT_TRUE(count.others.empty());
  EXPECT_EQ(count.value, 1);
}

TEST_F(PSystemByCount, CountsWhatASearchThroughAllPointsCounts) {
  const parts::Part bar = testing::block_part("bar", {0.080, 0.020, 0.010});
  parameters_.overlap_distance_m = 0.0015;
  std::mt19937 random(1);
  double counted_n = 0;
  double searched_n = 0;
  const auto pile = testing::random_pile(bar, 10, random);
  for (std::size_t i = 0; i < pile.size(); ++i) {
    const PSystemCount count = p_system_count(i, pile, parameters_);
    const std::uint32_t points_n = search_shared_points(i, pile, parameters_.overlap_distance_m);
    EXPECT_LE(count.points_n, points_n + 1) << "but for rounding";
    counted_n += count.points_n;
    searched_n += points_n;
  }
  EXPECT_GT(searched_n, 500);
  EXPECT_GT(counted_n, 0.97 * searched_n);
}

TEST(PSystemSupport, IsOneWhereNothingRestsAndFallsWithWhatDoes) {
  EXPECT_EQ(p_system_support(0, 0), 1);
  EXPECT_NEAR(p_system_support(0.5, 0.5), 0.5, 1e-12);
  for (int i = 0; i < 10; ++i) {
    const double load = 0.5 * i;
    EXPECT_GT(p_system_support(load, 1), p_system_support(load + 0.5, 1));
    EXPECT_GT(p_system_support(1, load), p_system_support(1, load + 0.5));
  }
}

TEST(PSystemSupport, IsTheTermThatThePileGraphGives) {
  const parts::Part brick = testing::block_part("brick", {0.040, 0.020, 0.010});
  const std::vector<PlacedPart> stack = {placed(brick, {0, 0, 0.005}),
                                         placed(brick, {0, 0, 0.015})};
  GrsParameters parameters;
  parameters.p_system = PSystem::kSupport;
  const PileGraph graph = make_pile_graph(stack, {});
  const auto terms = grasp_risk_scores(stack, graph, parameters);
  EXPECT_EQ(terms[1].p_system, 1);
  EXPECT_EQ(terms[0].load, graph.load[0]);
  EXPECT_EQ(terms[0].cover, graph.cover[0]);
  EXPECT_LT(terms[0].p_system, 0.5) << "a whole part rests on it";
  EXPECT_TRUE(terms[0].overlap_ids.empty()) << "the other P_system's evidence";
  EXPECT_TRUE(ranks_before(terms[1], terms[0], parameters));
}

TEST(GraspRiskScore, IsThePapersUnlessConfidenceCounts) {
  const parts::Part brick = testing::block_part("brick", {0.040, 0.020, 0.010});
  std::vector<PlacedPart> parts = {placed(brick, {0, 0, 0.005})};
  GrsParameters parameters;
  const auto grs = [&] {
    return grasp_risk_scores(parts, make_pile_graph(parts, {}), parameters)[0].grs;
  };
  const double paper = grs();
  parts[0].score = 0.5;
  EXPECT_EQ(grs(), paper);
  parameters.confidence = 2;
  EXPECT_NEAR(grs(), 0.25 * paper, 1e-12);
}

TEST(GraspRiskScore, PutsItsTermsTogether) {
  const parts::Part brick = testing::block_part("brick", {0.040, 0.020, 0.010});
  GrsParameters parameters;
  parameters.alpha = 2;
  parameters.beta = 10;
  parameters.k1 = 5;
  parameters.k2 = 0.1;
  parameters.neighbours_n = 1;
  // Two bricks 0.1 m apart, one 0.05 m up and pitched by 30°.
  const std::vector<PlacedPart> parts = {placed(brick, {0, 0, 0.05}, {0, M_PI / 6, 0}),
                                         placed(brick, {0.1, 0, 0.05})};
  const std::vector<GrsTerms> terms =
      grasp_risk_scores(parts, make_pile_graph(parts, {}), parameters);
  // P_self = 5·0.05 + 0.1·0.5 = 0.30, P_grasp = 0.01, GRS = (2·0.30 + 10·0.01)·1 = 0.70
  EXPECT_NEAR(terms[0].p_self, 0.30, 1e-9);
  EXPECT_NEAR(terms[0].p_grasp, 0.01, 1e-9);
  EXPECT_EQ(terms[0].p_system, 1);
  EXPECT_NEAR(terms[0].grs, 0.70, 1e-9);
  EXPECT_NEAR(terms[0].height_m, 0.05, 1e-9);
  EXPECT_NEAR(terms[0].inclination_rad, M_PI / 6, 1e-6);
  EXPECT_EQ(terms[0].neighbour_ids, std::vector<std::uint32_t>{1});
  // The flat one: (2·0.25 + 0.1)·1 = 0.60
  EXPECT_NEAR(terms[1].grs, 0.60, 1e-9);
}

TEST(GraspRiskScore, RanksByTheTextOrByTheEquation) {
  GrsTerms high;
  high.grs = high.p_self = 0.7;
  high.p_system = 1;
  GrsTerms low = high;
  low.grs = low.p_self = 0.6;
  GrsParameters parameters;
  EXPECT_TRUE(ranks_before(high, low, parameters));
  EXPECT_FALSE(ranks_before(low, high, parameters));
  parameters.order = GraspOrder::kAscending;
  EXPECT_TRUE(ranks_before(low, high, parameters));
  EXPECT_FALSE(ranks_before(high, high, parameters));
}

TEST(GraspRiskScore, AmongSupportingPartsTheFreerRanksFirst) {
  GrsTerms high;
  high.p_self = 0.7;
  GrsTerms low;
  low.p_self = 0.6;
  EXPECT_TRUE(ranks_before(high, low, {}));
  EXPECT_FALSE(ranks_before(low, high, {}));
}

}  // namespace
}  // namespace graspd::perception
