/// Who lies on whom, in piles whose answer is known and in random ones.
#include "graspd/perception/pile_graph.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "random_pile.hpp"

namespace graspd::perception {
namespace {

using Eigen::Vector3d;
using ::testing::ElementsAre;
using ::testing::IsEmpty;
using testing::long_bar;
using testing::placed;

/// Upright: 60 mm wide, 50 mm high, 10 mm thick, with a window of 40 by 30 mm.
const parts::Part& frame() {
  static const parts::Part part = [] {
    parts::Part joined = testing::block_part("frame", {0.060, 0.010, 0.010});
    const auto add = [&](const Vector3d& size_m, const Vector3d& at_m) {
      for (parts::SurfacePoint point : testing::block_part("piece", size_m).surface) {
        point.position_m += at_m.cast<float>();
        joined.surface.push_back(point);
      }
    };
    for (auto& point : joined.surface) point.position_m.z() -= 0.020f;
    add({0.060, 0.010, 0.010}, {0, 0, 0.020});
    add({0.010, 0.010, 0.030}, {-0.025, 0, 0});
    add({0.010, 0.010, 0.030}, {0.025, 0, 0});
    joined.radius_m = 0.040;
    joined.contact = parts::ContactModel(joined.surface);
    return joined;
  }();
  return part;
}

TEST(PileGraph, OneOnTopOfTheOther) {
  const std::vector<PlacedPart> stack = {placed(long_bar(), {0, 0, 0.005}),
                                         placed(long_bar(), {0, 0, 0.015}, {0, 0, M_PI / 2})};
  const PileGraph graph = make_pile_graph(stack, {});
  EXPECT_THAT(graph.lies_on[1], ElementsAre(0));
  EXPECT_THAT(graph.supports[0], ElementsAre(1));
  EXPECT_THAT(graph.lies_on[0], IsEmpty());
  EXPECT_THAT(graph.supports[1], IsEmpty());
  EXPECT_THAT(graph.entangled_with[0], IsEmpty());
  EXPECT_NEAR(graph.load[0], 1, 0.05);
  EXPECT_EQ(graph.load[1], 0);
  EXPECT_EQ(graph.cover[1], 0);
  EXPECT_TRUE(graph.is_free(1));
  EXPECT_FALSE(graph.is_free(0));
}

TEST(PileGraph, SideBySideNothingRests) {
  const std::vector<PlacedPart> row = {placed(long_bar(), {0, 0, 0.005}),
                                       placed(long_bar(), {0, 0.0205, 0.005})};
  const PileGraph graph = make_pile_graph(row, {});
  for (std::size_t i : {0U, 1U}) {
    EXPECT_THAT(graph.lies_on[i], IsEmpty());
    EXPECT_TRUE(graph.is_free(i));
  }
}

TEST(PileGraph, ABridgeRestsHalfOnEachPillarAndOneWithoutContactIsOverTheMiddle) {
  const parts::Part small = testing::block_part("small", {0.020, 0.014, 0.008});
  const Vector3d x_to_y_to_z = Vector3d::Constant(2 * M_PI / 3 / std::sqrt(3.0));  // on edge
  const std::vector<PlacedPart> bridge = {placed(long_bar(), {-0.035, 0, 0.010}, x_to_y_to_z),
                                          placed(long_bar(), {0.035, 0, 0.010}, x_to_y_to_z),
                                          placed(long_bar(), {0, 0, 0.025}),
                                          placed(small, {0, 0, 0.004})};
  const PileGraph graph = make_pile_graph(bridge, {});
  EXPECT_THAT(graph.lies_on[2], ElementsAre(0, 1));
  EXPECT_NEAR(graph.load[0], 0.5, 0.1);
  EXPECT_NEAR(graph.load[1], 0.5, 0.1);
  EXPECT_THAT(graph.lies_on[3], IsEmpty());
  EXPECT_THAT(graph.supports[3], IsEmpty());
  EXPECT_THAT(graph.double_picks[3], ElementsAre(2)) << "the lift would meet it";
  EXPECT_FALSE(graph.is_free(3));
}

TEST(PileGraph, WeightGoesDownThroughOthers) {
  std::vector<PlacedPart> tower;
  for (int i = 0; i < 5; ++i) {
    tower.push_back(placed(long_bar(), {0, 0, 0.005 + 0.010 * i}, {0, 0, i % 2 * M_PI / 2}));
  }
  const PileGraph graph = make_pile_graph(tower, {});
  for (std::size_t i = 0; i + 1 < tower.size(); ++i) {
    EXPECT_THAT(graph.supports[i], ElementsAre(i + 1)) << "of what it touches";
    EXPECT_GT(graph.load[i], graph.load[i + 1]);
  }
  EXPECT_NEAR(graph.load[0], 4, 0.3);
}

TEST(PileGraph, WhatRunsThroughAFrameIsEntangledWithIt) {
  const std::vector<PlacedPart> pile = {placed(frame(), {0, 0, 0.025}),
                                        placed(long_bar(), {0, 0, 0.0155}, {0, 0, M_PI / 2}),
                                        placed(long_bar(), {0.06, 0, 0.005}, {0, 0, M_PI / 2})};
  const PileGraph graph = make_pile_graph(pile, {});
  EXPECT_THAT(graph.entangled_with[0], ElementsAre(1));
  EXPECT_THAT(graph.entangled_with[1], ElementsAre(0));
  EXPECT_THAT(graph.lies_on[1], ElementsAre(0));
  EXPECT_THAT(graph.entangled_with[2], IsEmpty());
}

/// Four bars in a square, each with its head on the next one's foot.
std::vector<PlacedPart> ring_of_bars() {
  std::vector<PlacedPart> ring;
  for (int i = 0; i < 4; ++i) {
    PlacedPart part{&long_bar(), Eigen::Isometry3d::Identity()};
    part.T_floor_part.rotate(Eigen::AngleAxisd(i * M_PI / 2, Vector3d::UnitZ()));
    part.T_floor_part.translate(Vector3d(0, -0.035, 0.012));
    part.T_floor_part.rotate(Eigen::AngleAxisd(-0.143, Vector3d::UnitY()));
    ring.push_back(part);
  }
  return ring;
}

TEST(PileGraph, OfARingOfPartsTheWeakestEdgeIsEntanglement) {
  const PileGraph graph = make_pile_graph(ring_of_bars(), {});
  std::size_t edges_n = 0;
  std::size_t entangled_n = 0;
  for (std::size_t i = 0; i < 4; ++i) {
    edges_n += graph.lies_on[i].size();
    entangled_n += graph.entangled_with[i].size();
  }
  EXPECT_EQ(edges_n, 3U);
  EXPECT_EQ(entangled_n, 2U);
}

bool is_acyclic(const PileGraph& graph) {
  // Take away what nothing rests on, again and again.
  std::vector<std::size_t> above_n;
  for (const auto& upper : graph.supports) above_n.push_back(upper.size());
  std::vector<std::size_t> free;
  for (std::size_t i = 0; i < above_n.size(); ++i) {
    if (above_n[i] == 0) free.push_back(i);
  }
  for (std::size_t k = 0; k < free.size(); ++k) {
    for (const std::uint32_t below : graph.lies_on[free[k]]) {
      if (--above_n[below] == 0) free.push_back(below);
    }
  }
  return free.size() == above_n.size();
}

TEST(PileGraph, OfRandomPilesIsAcyclicSymmetricAndItsLoadIsTheEdges) {
  std::mt19937 random(3);
  std::size_t edges_n = 0;
  for (int round = 0; round < 10; ++round) {
    const auto pile = testing::random_pile(long_bar(), 25, random);
    const PileGraph graph = make_pile_graph(pile, {});
    EXPECT_TRUE(is_acyclic(graph));
    for (std::uint32_t i = 0; i < pile.size(); ++i) {
      for (const std::uint32_t below : graph.lies_on[i]) {
        EXPECT_THAT(graph.supports[below], ::testing::Contains(i));
        EXPECT_GT(graph.load[below], 0);
        ++edges_n;
      }
      for (const std::uint32_t other : graph.entangled_with[i]) {
        EXPECT_THAT(graph.entangled_with[other], ::testing::Contains(i));
      }
      EXPECT_EQ(graph.supports[i].empty(), graph.load[i] == 0);
      EXPECT_TRUE(std::ranges::is_sorted(graph.supports[i]));
    }
  }
  EXPECT_GT(edges_n, 100U);
}

TEST(PileGraph, TheOrderOfThePartsDoesNotMatter) {
  std::mt19937 random(4);
  const auto pile = testing::random_pile(long_bar(), 25, random);
  std::vector<std::uint32_t> order(pile.size());
  std::iota(order.begin(), order.end(), 0U);
  std::shuffle(order.begin(), order.end(), random);
  std::vector<PlacedPart> shuffled;
  for (const std::uint32_t i : order) shuffled.push_back(pile[i]);

  const PileGraph graph = make_pile_graph(pile, {});
  const PileGraph again = make_pile_graph(shuffled, {});
  std::size_t same_n = 0;
  std::size_t all_n = 0;
  for (std::size_t k = 0; k < order.size(); ++k) {
    std::vector<std::uint32_t> lies_on;
    for (const std::uint32_t i : again.lies_on[k]) lies_on.push_back(order[i]);
    std::ranges::sort(lies_on);
    ++all_n;
    same_n += lies_on == graph.lies_on[order[k]];
  }
  EXPECT_EQ(same_n, all_n);
}

TEST(PileGraph, WithoutPartsOrWithOneIsEmpty) {
  EXPECT_TRUE(make_pile_graph({}, {}).load.empty());
  const std::vector<PlacedPart> one = {placed(long_bar(), {0, 0, 0.005})};
  EXPECT_TRUE(make_pile_graph(one, {}).is_free(0));
}

}  // namespace
}  // namespace graspd::perception
