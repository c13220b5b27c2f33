#include <gmock/gmock.h>

#include <future>

#include "graspd/simulation/pile.hpp"
#include "sim_meshes.hpp"

namespace graspd::simulation {
namespace {

using testing::box_mesh;
using ::testing::HasSubstr;
using testing::pipe_mesh;

const Eigen::Vector3d kBrick_m(0.02, 0.03, 0.05);
const Eigen::Vector3d kBin_m(0.2, 0.16, 0.1);

bool same(const Pile& a, const Pile& b) {
  if (a.parts.size() != b.parts.size()) return false;
  for (std::size_t i = 0; i < a.parts.size(); ++i) {
    if (a.parts[i].kind != b.parts[i].kind ||
        a.parts[i].T_bin_part.matrix() != b.parts[i].T_bin_part.matrix()) {
      return false;
    }
  }
  return true;
}

/// How deep two boxes of size kBrick_m overlap, by the separating axis theorem; negative: apart.
double overlap_m(const Eigen::Isometry3d& a, const Eigen::Isometry3d& b) {
  std::vector<Eigen::Vector3d> axes;
  for (int i = 0; i < 3; ++i) {
    axes.push_back(a.linear().col(i));
    axes.push_back(b.linear().col(i));
    for (int j = 0; j < 3; ++j) {
      const Eigen::Vector3d cross = a.linear().col(i).cross(b.linear().col(j));
      if (cross.norm() > 1e-3) axes.push_back(cross.normalized());
    }
  }
  double least = std::numeric_limits<double>::max();
  for (const auto& axis : axes) {
    const double half_a = (a.linear().transpose() * axis).cwiseAbs().dot(kBrick_m / 2);
    const double half_b = (b.linear().transpose() * axis).cwiseAbs().dot(kBrick_m / 2);
    least =
        std::min(least, half_a + half_b - std::abs((a.translation() - b.translation()).dot(axis)));
  }
  return least;
}

class PileTest : public ::testing::Test {
 protected:
  const PileMaker boxes{{box_mesh(kBrick_m)}};
};

TEST_F(PileTest, ABoxAloneLiesOnOneOfItsFaces) {
  for (std::uint64_t seed = 0; seed < 8; ++seed) {
    const auto pile = boxes.drop({1}, kBin_m, seed);
    ASSERT_TRUE(pile) << pile.error().message;
    const Eigen::Isometry3d& T = pile->parts.at(0).T_bin_part;
    // The face's normal is vertical, and the centre half the box's size above the floor.
    Eigen::Index axis = 0;
    EXPECT_GT(T.linear().row(2).cwiseAbs().maxCoeff(&axis), std::cos(0.02)) << seed;
    EXPECT_NEAR(T.translation().z(), kBrick_m[axis] / 2, 0.0005) << seed;
    EXPECT_TRUE((T.linear() * T.linear().transpose()).isIdentity(1e-6));
  }
}

TEST_F(PileTest, PartsLieWithinTheBinAndOutOfEachOther) {
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    const auto pile = boxes.drop({30}, kBin_m, seed);
    ASSERT_TRUE(pile) << pile.error().message;
    EXPECT_EQ(pile->parts.size() + pile->removed_n, 30u);
    EXPECT_LE(pile->deepest_penetration_m, PileOptions().max_penetration_m);
    for (std::size_t i = 0; i < pile->parts.size(); ++i) {
      const Eigen::Isometry3d& T = pile->parts[i].T_bin_part;
      const Eigen::Vector3d half_m = T.linear().cwiseAbs() * kBrick_m / 2;
      EXPECT_GT(T.translation().z() - half_m.z(), -0.001);
      if (T.translation().z() + half_m.z() < kBin_m.z()) {
        EXPECT_LT(std::abs(T.translation().x()) + half_m.x(), kBin_m.x() / 2 + 0.001);
        EXPECT_LT(std::abs(T.translation().y()) + half_m.y(), kBin_m.y() / 2 + 0.001);
      }
      for (std::size_t j = 0; j < i; ++j) {
        EXPECT_LT(overlap_m(T, pile->parts[j].T_bin_part), 0.001) << i << " and " << j;
      }
    }
  }
}

TEST_F(PileTest, NoPartHangsInTheAir) {
  const auto pile = boxes.drop({12}, kBin_m, 5);
  ASSERT_TRUE(pile);
  for (std::size_t i = 0; i < pile->parts.size(); ++i) {
    Eigen::Isometry3d lower = pile->parts[i].T_bin_part;
    const double bottom_m =
        lower.translation().z() - (lower.linear().cwiseAbs() * kBrick_m / 2).z();
    if (bottom_m < 0.001) continue;
    lower.translation().z() -= 0.0015;
    bool held = false;
    for (std::size_t j = 0; j < pile->parts.size(); ++j) {
      held = held || (j != i && overlap_m(lower, pile->parts[j].T_bin_part) > 0);
    }
    EXPECT_TRUE(held) << "part " << i << " " << bottom_m;
  }
}

TEST_F(PileTest, TheSeedMakesThePile) {
  const auto a = boxes.drop({15}, kBin_m, 11);
  const auto b = boxes.drop({15}, kBin_m, 11);
  const auto c = boxes.drop({15}, kBin_m, 12);
  ASSERT_TRUE(a && b && c);
  EXPECT_TRUE(same(*a, *b));
  EXPECT_FALSE(same(*a, *c));
}

TEST_F(PileTest, PilesMadeAtOnceAreThoseMadeOneByOne) {
  const auto drop = [this](std::uint64_t seed) { return boxes.drop({15}, kBin_m, seed); };
  auto first = std::async(std::launch::async, drop, 1);
  auto second = std::async(std::launch::async, drop, 2);
  const auto first_at_once = first.get(), second_at_once = second.get();
  EXPECT_TRUE(same(*first_at_once, *drop(1)));
  EXPECT_TRUE(same(*second_at_once, *drop(2)));
}

TEST_F(PileTest, KindsAreMixed) {
  const PileMaker two({box_mesh(kBrick_m), pipe_mesh(0.012, 0.009, 0.04)});
  const auto pile = two.drop({6, 9}, kBin_m, 3);
  ASSERT_TRUE(pile) << pile.error().message;
  const auto of_kind = [&](std::size_t kind) {
    return std::count_if(pile->parts.begin(), pile->parts.end(),
                         [kind](const PiledPart& part) { return part.kind == kind; });
  };
  EXPECT_EQ(of_kind(0), 6);
  EXPECT_EQ(of_kind(1), 9);
}

TEST_F(PileTest, WhatDoesNotFitIsDroppedAgainAndThenLeftOut) {
  const Eigen::Vector3d small_m(0.07, 0.07, 0.03);
  const auto pile = boxes.drop({30}, small_m, 1);
  ASSERT_TRUE(pile) << pile.error().message;
  EXPECT_GT(pile->dropped_again_n, 0);
  EXPECT_GT(pile->removed_n, 0);
  EXPECT_EQ(pile->parts.size() + pile->removed_n, 30u);
  for (const PiledPart& part : pile->parts) {
    EXPECT_LE(std::abs(part.T_bin_part.translation().x()), small_m.x() / 2);
    EXPECT_LE(std::abs(part.T_bin_part.translation().y()), small_m.y() / 2);
  }
}

TEST_F(PileTest, NoPartsMakeAnEmptyPile) {
  const auto pile = boxes.drop({0}, kBin_m, 1);
  ASSERT_TRUE(pile);
  EXPECT_TRUE(pile->parts.empty());
}

TEST_F(PileTest, ImpossibleRequestsAreNamed) {
  EXPECT_THAT(boxes.drop({1, 2}, kBin_m, 1).error().message, HasSubstr("2 numbers for 1 kind"));
  EXPECT_THAT(boxes.drop({-1}, kBin_m, 1).error().message, HasSubstr("counts[0]: -1"));
  EXPECT_THAT(boxes.drop({1}, {0.2, 0, 0.1}, 1).error().message, HasSubstr("bin_inner_size_m"));
}

}  // namespace
}  // namespace graspd::simulation
