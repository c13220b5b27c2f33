#include "graspd/perception/wall_bow.hpp"

#include <gtest/gtest.h>

#include <random>

#include "block_grid.hpp"
#include "graspd/perception/hypotheses.hpp"

namespace graspd::perception {
namespace {

/// Blocks that lean about in a bin, which bows what is seen of them.
class BlocksInABin : public ::testing::Test {
 protected:
  static constexpr double kFloor_m = 0.75;
  const Eigen::Vector3d bin_size_m_{0.30, 0.24, 0.12};

  BlocksInABin() {
    std::mt19937 random(1);
    std::uniform_real_distribution<double> angle_rad(0.2, 0.7);
    std::normal_distribution<double> direction;
    for (const double x_m : {-0.10, 0.0, 0.10}) {
      for (const double y_m : {-0.08, 0.0, 0.08}) {
        Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
        const double a = direction(random);
        const double b = direction(random);
        T.translate(Eigen::Vector3d(x_m, y_m, kFloor_m - 0.04));
        T.rotate(Eigen::AngleAxisd(angle_rad(random),
                                   Eigen::Vector3d(a, b, direction(random)).normalized()));
        blocks_.push_back({T, block_size_m_});
      }
    }
    Eigen::Isometry3d T_camera_bin(Eigen::AngleAxisd(M_PI, Eigen::Vector3d::UnitX()));
    T_camera_bin.translation().z() = kFloor_m;
    walls_ = bowed_walls(T_camera_bin, bin_size_m_, 0.075);
  }

  DepthGrid seen(double bow_m) const {
    DepthGrid grid = testing::grid_of(blocks_, kFloor_m);
    straighten(grid, walls_, -bow_m);
    pack(grid);
    return grid;
  }

  double found_m(const DepthGrid& grid) const {
    const PoseVerifier verifier(grid, parts_, parameters_);
    const auto poses = find_hypotheses(grid, verifier, parts_, parameters_).poses;
    return find_wall_bow_m(grid, verifier, poses, walls_);
  }

  /// As registration does, which straightens the image after each round.
  double found_in_rounds_m(DepthGrid grid, int rounds_n) const {
    double bow_m = 0;
    for (int round = 0; round < rounds_n; ++round) {
      const double more_m = found_m(grid);
      straighten(grid, walls_, more_m);
      pack(grid);
      bow_m += more_m;
    }
    return bow_m;
  }

  const Eigen::Vector3d block_size_m_{0.07, 0.05, 0.03};
  RegistrationParameters parameters_;
  std::vector<testing::Block> blocks_;
  parts::Part block_ = testing::block_part("block", block_size_m_);
  const parts::Part* const parts_[1] = {&block_};
  BowedWalls walls_;
};

TEST_F(BlocksInABin, WhichAreBentSayByHowMuch) {
  EXPECT_NEAR(found_m(seen(0)), 0, 0.001);
  EXPECT_NEAR(found_in_rounds_m(seen(0.004), 2), 0.004, 0.0015);
  EXPECT_NEAR(found_in_rounds_m(seen(-0.004), 2), -0.004, 0.0015);
}

TEST_F(BlocksInABin, SayItInMoreRoundsWhereItIsMuch) {
  EXPECT_NEAR(found_in_rounds_m(seen(0.012), 3), 0.012, 0.002);
}

TEST_F(BlocksInABin, FarFromItsWallsSayNothing) {
  walls_.half_size_m *= 3;
  EXPECT_EQ(found_m(seen(0)), 0);
}

TEST_F(BlocksInABin, NoPosesSayNothing) {
  const DepthGrid grid = seen(0.004);
  EXPECT_EQ(find_wall_bow_m(grid, PoseVerifier(grid, parts_, parameters_), {}, walls_), 0);
}

TEST(Straighten, FallsWithTheSquareOfWhatIsLeftOfTheReach) {
  Eigen::Isometry3d T_camera_bin(Eigen::AngleAxisd(M_PI, Eigen::Vector3d::UnitX()));
  T_camera_bin.translation().z() = 0.75;
  const BowedWalls walls = bowed_walls(T_camera_bin, {0.30, 0.24, 0.12}, 0.08);
  EXPECT_FLOAT_EQ(walls.share_at({0, 0, 0.7F}), 0);
  EXPECT_NEAR(walls.share_at({0.15F, 0, 0.7F}), 1, 1e-5);
  EXPECT_NEAR(walls.share_at({0.11F, 0, 0.7F}), 0.25, 1e-5);        // half of the reach away
  EXPECT_NEAR(walls.share_at({-0.11F, 0.1F, 0.7F}), 0.5625, 1e-5);  // the nearer wall counts
  EXPECT_FLOAT_EQ(walls.share_at({0.16F, 0, 0.7F}), 0);             // the rim
}

}  // namespace
}  // namespace graspd::perception
