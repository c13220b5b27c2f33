#include "graspd/perception/pose_hypothesis.hpp"

#include <gtest/gtest.h>

#include <random>
#include <set>

#include "block_grid.hpp"
#include "random_points.hpp"

namespace graspd::perception {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3f;

class OneBlock : public ::testing::Test {
 protected:
  static constexpr double kFloor_m = 0.75;
  const Vector3d size_m_{0.09, 0.05, 0.03};

  OneBlock() {
    Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
    T.translate(Vector3d(0.02, 0.01, 0.70));
    T.rotate(Eigen::AngleAxisd(0.5, Vector3d(1, 0.6, 0.3).normalized()));
    grid_ = testing::grid_of({{T, size_m_}}, kFloor_m);
    truth_.R = T.linear().cast<float>();
    truth_.t_m = T.translation().cast<float>();
  }

  RegistrationParameters parameters_;
  DepthGrid grid_;
  parts::Part block_ = testing::block_part("block", size_m_);
  const parts::Part* const parts_[1] = {&block_};
  PoseVerifier verifier_{grid_, parts_, parameters_};
  PoseHypothesis truth_;
};

TEST_F(OneBlock, SupportsTheTruePose) {
  ASSERT_TRUE(verifier_.score(truth_, 10'000, 0.006));
  EXPECT_GT(truth_.counts.support_n, 0.97 * truth_.counts.tested_n);
  EXPECT_LT(truth_.counts.refute_n, 0.01 * truth_.counts.tested_n);
  verifier_.score_finally(truth_);
  EXPECT_GT(truth_.score, 0.6) << "of its largest view, seen aslant";
}

TEST_F(OneBlock, RefutesAPoseInTheAirAndHidesOneBelowTheSurface) {
  PoseHypothesis above = truth_, below = truth_;
  above.t_m.z() -= 0.02F;
  below.t_m.z() += 0.02F;
  verifier_.score(above, 10'000, 0.006);
  verifier_.score(below, 10'000, 0.006);
  EXPECT_GT(above.counts.refute_n, 0.9 * above.counts.tested_n);
  EXPECT_LT(above.score, 0);
  EXPECT_GT(below.counts.hidden_n, 0.7 * below.counts.tested_n);
  EXPECT_LT(below.score, 0.15);
}

TEST_F(OneBlock, IsTheLessProbableTheFartherOffItIs) {
  EXPECT_FALSE(verifier_.score_finally(truth_));
  EXPECT_GT(truth_.confidence, 0.8F);
  float nearer = truth_.confidence;
  for (const float off_m : {0.003F, 0.006F, 0.012F}) {
    PoseHypothesis off = truth_;
    off.t_m.x() += off_m;
    verifier_.score_finally(off);
    EXPECT_LT(off.confidence, nearer) << off_m << " m";
    nearer = off.confidence;
  }
  EXPECT_LT(nearer, parameters_.min_confidence);
}

TEST_F(OneBlock, StopsEarlyOnABadStart) {
  PoseHypothesis above = truth_;
  above.t_m.z() -= 0.02F;
  EXPECT_FALSE(verifier_.score(above, 64, 0.006, {4, 4}));
  EXPECT_EQ(above.counts.tested_n, 16);
}

TEST_F(OneBlock, RefinementBringsBackAPoseThatIsOff) {
  std::mt19937 random(3);
  for (int round = 0; round < 20; ++round) {
    PoseHypothesis pose = truth_;
    const Vector3f axis = testing::random_point(random, 1).normalized();
    pose.R = Eigen::AngleAxisf(0.12F, axis).toRotationMatrix() * pose.R;
    pose.t_m += 0.005F * testing::random_point(random, 1).normalized();
    for (int k = 0; k < 6; ++k) verifier_.icp_step(pose, 64, 0.012);
    verifier_.refine(pose);
    // Within about a pixel, which is 1.9 mm here.
    EXPECT_LT((pose.t_m - truth_.t_m).norm(), 0.0025F) << "round " << round;
    const float angle_rad = Eigen::AngleAxisf(pose.R.transpose() * truth_.R).angle();
    EXPECT_LT(angle_rad, 0.04F) << "round " << round;
  }
}

TEST_F(OneBlock, ExplainsItsOwnPixels) {
  CellMarks marks(grid_.size());
  const auto cells = verifier_.explained_cells(truth_, 0.01, marks);
  std::size_t of_part_n = 0, explained_n = 0;
  for (std::size_t i = 0; i < grid_.z_m.size(); ++i) {
    // The block, not the floor around it.
    of_part_n += grid_.is_part[i] != 0 && grid_.z_m[i] < kFloor_m - 0.006;
  }
  for (const std::size_t cell : cells) explained_n += grid_.z_m[cell] < kFloor_m - 0.006;
  EXPECT_GT(explained_n, 0.95 * static_cast<double>(of_part_n));
  EXPECT_EQ(std::set<std::size_t>(cells.begin(), cells.end()).size(), cells.size()) << "each once";
}

}  // namespace
}  // namespace graspd::perception
