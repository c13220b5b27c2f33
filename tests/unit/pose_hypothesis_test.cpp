#include "graspd/perception/pose_hypothesis.hpp"

#include <gtest/gtest.h>

#include <random>

#include "block_scene.hpp"
#include "graspd/perception/preprocess.hpp"
#include "random_points.hpp"

namespace graspd::perception {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3f;

/// What the kernel is to compute, one point after the other.
PoseCounts count_by_hand(const PackedDepth& depth, const KernelPose& pose, const PointSpan& points,
                         float tolerance_m, const EarlyStop& stop) {
  PoseCounts counts;
  const float tolerance = tolerance_m / PackedDepth::kUnit_m;
  for (std::size_t i = 0; i < points.size; ++i) {
    const auto row = [&](int k) {
      return std::fma(pose.R[3 * k], points.x_m[i],
                      std::fma(pose.R[3 * k + 1], points.y_m[i],
                               std::fma(pose.R[3 * k + 2], points.z_m[i], pose.t_m[k])));
    };
    const float inverse = 1.0F / row(2);
    const auto u =
        static_cast<int>(std::nearbyint(std::fma(row(0) * inverse, depth.fx_px, depth.cx_px)));
    const auto v =
        static_cast<int>(std::nearbyint(std::fma(row(1) * inverse, depth.fy_px, depth.cy_px)));
    ++counts.tested_n;
    if (u >= 0 && v >= 0 && u < depth.width_px && v < depth.height_px) {
      const std::uint32_t cell = depth.cells[v * depth.width_px + u];
      const float expected = row(2) * (1 / PackedDepth::kUnit_m);
      const float error = static_cast<float>(cell & 0xFFFFU) - expected;
      const float nearest_error = static_cast<float>(cell >> 16U) - expected;
      if ((cell & 0xFFFFU) != 0) {
        counts.hidden_n += error < -tolerance;
        counts.refute_n += nearest_error > tolerance;
        if (std::abs(error) <= tolerance) {
          ++counts.support_n;
          const auto whole = static_cast<std::int32_t>(std::nearbyint(error));
          counts.error2_sum += whole * whole;
        }
      }
    }
    if (i + 1 == 16 && points.size > 16 &&
        (counts.support_n < stop.min_support_n || counts.refute_n > stop.max_refute_n)) {
      break;
    }
  }
  return counts;
}

TEST(PoseKernel, CountsAsOnePointAfterTheOther) {
  std::mt19937 random(11);
  std::uniform_int_distribution<std::uint32_t> reading(6900, 7300);
  constexpr int kWidth = 64, kHeight = 48;
  std::vector<std::uint32_t> cells(kWidth * kHeight, 0);
  for (int v = 1; v < kHeight - 1; ++v) {
    for (int u = 1; u < kWidth - 1; ++u) {
      const std::uint32_t z = random() % 10 == 0 ? 0 : reading(random);
      const auto nearest = z == 0 ? 0 : z - static_cast<std::uint32_t>(random() % 100);
      cells[std::size_t(v * kWidth + u)] = z | nearest << 16U;
    }
  }
  const PackedDepth depth{cells.data(), kWidth, kHeight, 365, 365, 31, 23};
  for (int round = 0; round < 300; ++round) {
    const std::size_t count = 1 + random() % 90;
    std::vector<float> x(count + 16), y(count + 16), z(count + 16);
    for (std::size_t i = 0; i < count; ++i) {
      const Vector3f p = testing::random_point(random, 0.06F);
      x[i] = p.x(), y[i] = p.y(), z[i] = p.z() / 4;
    }
    const Eigen::Matrix3d R = testing::random_rotation(random).toRotationMatrix();
    KernelPose pose{};
    for (int k = 0; k < 9; ++k) pose.R[k] = static_cast<float>(R(k / 3, k % 3));
    pose.t_m[2] = 0.71F;
    const PointSpan points{x.data(), y.data(), z.data(), count};
    const EarlyStop stop = round % 2 == 0 ? EarlyStop{} : EarlyStop{4, 4};
    const PoseCounts counts = count_evidence(depth, pose, points, 0.008F, stop);
    const PoseCounts expected = count_by_hand(depth, pose, points, 0.008F, stop);
    EXPECT_EQ(counts.tested_n, expected.tested_n);
    EXPECT_EQ(counts.support_n, expected.support_n);
    EXPECT_EQ(counts.refute_n, expected.refute_n);
    EXPECT_EQ(counts.hidden_n, expected.hidden_n);
    EXPECT_EQ(counts.error2_sum, expected.error2_sum);
  }
}

class OneBlock : public ::testing::Test {
 protected:
  static constexpr double kFloor_m = 0.75;
  const Vector3d size_m_{0.09, 0.05, 0.03};

  OneBlock() {
    preprocess_.stray_light_share = 0;
    Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
    T.translate(Vector3d(0.02, 0.01, 0.70));
    T.rotate(Eigen::AngleAxisd(0.5, Vector3d(1, 0.6, 0.3).normalized()));
    frame_ = testing::render(testing::kinect_v2(), kFloor_m, {{T, size_m_}});
    Cloud cloud = unproject(frame_, preprocess_);
    std::erase_if(cloud.points_m, [](const Vector3f& p) { return p.z() > kFloor_m - 0.005; });
    grid_ = make_depth_grid(frame_, cloud, preprocess_);
    truth_.R = T.linear().cast<float>();
    truth_.t_m = T.translation().cast<float>();
  }

  PreprocessParameters preprocess_;
  RegistrationParameters parameters_;
  DepthFrame frame_;
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
  const auto cells = verifier_.explained_cells(truth_, 0.01);
  std::size_t of_part_n = 0, explained_n = 0;
  for (std::size_t i = 0; i < grid_.z_m.size(); ++i) {
    // The block, not the floor around it.
    of_part_n += grid_.is_part[i] != 0 && grid_.z_m[i] < kFloor_m - 0.006;
  }
  for (const std::size_t cell : cells) explained_n += grid_.z_m[cell] < kFloor_m - 0.006;
  EXPECT_GT(explained_n, 0.95 * static_cast<double>(of_part_n));
  EXPECT_TRUE(std::is_sorted(cells.begin(), cells.end()));
}

}  // namespace
}  // namespace graspd::perception
