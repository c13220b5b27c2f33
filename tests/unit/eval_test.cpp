#include <gtest/gtest.h>

#include <cmath>

#include "block_scene.hpp"
#include "graspd/eval/pose_error.hpp"
#include "graspd/eval/segmentation_accuracy.hpp"

namespace graspd::eval {
namespace {

using Eigen::Vector3d;

Eigen::Isometry3d at(double x_m, double yaw_rad = 0) {
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  T.translate(Vector3d(x_m, 0, 0.7));
  T.rotate(Eigen::AngleAxisd(yaw_rad, Vector3d::UnitZ()));
  return T;
}

class PoseErrors : public ::testing::Test {
 protected:
  parts::Part part_ = testing::block_part("block", {0.06, 0.04, 0.02});
};

TEST_F(PoseErrors, OfAShiftIsTheShift) {
  EXPECT_NEAR(mssd_m(part_, at(0.003), at(0)), 0.003, 1e-9);
  EXPECT_NEAR(mssd_m(part_, at(0), at(0)), 0, 1e-9);
}

TEST_F(PoseErrors, OfATurnIsTheFarthestCornersWay) {
  // Half the diagonal of 60 × 40 mm is 36.06 mm; turned by 180° a corner moves by 72.1 mm.
  EXPECT_NEAR(mssd_m(part_, at(0, M_PI), at(0)), 0.07211, 1e-5);
}

TEST_F(PoseErrors, ForgivesSymmetries) {
  Eigen::Isometry3d half_turn = Eigen::Isometry3d::Identity();
  half_turn.rotate(Eigen::AngleAxisd(M_PI, Vector3d::UnitZ()));
  part_.symmetries.discrete = {half_turn};
  EXPECT_EQ(all_symmetries(part_).size(), 2U);
  EXPECT_NEAR(mssd_m(part_, at(0, M_PI), at(0)), 0, 1e-6);
  part_.symmetries.continuous = {{Vector3d::UnitZ(), Vector3d::Zero()}};
  EXPECT_LT(mssd_m(part_, at(0, 1.234), at(0)), 0.01 * part_.diameter_m);
}

Eigen::Isometry3d turned(double angle_rad, const Vector3d& axis) {
  Eigen::Isometry3d T = at(0);
  T.rotate(Eigen::AngleAxisd(angle_rad, axis.normalized()));
  return T;
}

TEST_F(PoseErrors, AreTheBarycentresWayAndTheAngle) {
  part_.barycentre_m = {0.01, 0, 0};
  const double yaw_rad = 0.2;
  const auto error = pose_error(part_, at(0.003, yaw_rad), at(0));
  EXPECT_NEAR(error.rotation_rad, yaw_rad, 1e-9);
  const Vector3d way_m(0.003 + 0.01 * (std::cos(yaw_rad) - 1), 0.01 * std::sin(yaw_rad), 0);
  EXPECT_NEAR(error.translation_m, way_m.norm(), 1e-9);
  EXPECT_NEAR(pose_error(part_, turned(M_PI, {1, 2, 3}), at(0)).rotation_rad, M_PI, 1e-9);
}

TEST_F(PoseErrors, AreTheLeastOverDiscreteSymmetries) {
  Eigen::Isometry3d half_turn = Eigen::Isometry3d::Identity();
  half_turn.rotate(Eigen::AngleAxisd(M_PI, Vector3d::UnitZ()));
  part_.symmetries.discrete = {half_turn};
  const auto error = pose_error(part_, at(0.002, M_PI + 0.1), at(0));
  EXPECT_NEAR(error.rotation_rad, 0.1, 1e-9);
  EXPECT_NEAR(error.translation_m, 0.002, 1e-9);
}

TEST_F(PoseErrors, CountNoTurnAboutAContinuousAxis) {
  part_.symmetries.continuous = {{Vector3d(0, 0, 2), Vector3d::Zero()}};
  EXPECT_NEAR(pose_error(part_, turned(1.234, Vector3d::UnitZ()), at(0)).rotation_rad, 0, 1e-9);
  EXPECT_NEAR(pose_error(part_, turned(0.3, Vector3d::UnitX()), at(0)).rotation_rad, 0.3, 1e-9);
  const Eigen::Isometry3d tilted_and_turned =
      turned(0.3, Vector3d(1, 1, 0)) * Eigen::AngleAxisd(2.5, Vector3d::UnitZ());
  EXPECT_NEAR(pose_error(part_, tilted_and_turned, at(0)).rotation_rad, 0.3, 1e-9);
  EXPECT_NEAR(pose_error(part_, turned(M_PI, Vector3d::UnitX()), at(0)).rotation_rad, M_PI, 1e-9)
      << "upside down is no turn about z";
  part_.symmetries.continuous.push_back({Vector3d::UnitX(), Vector3d::Zero()});
  EXPECT_EQ(pose_error(part_, turned(1, Vector3d(1, 2, 3)), at(0)).rotation_rad, 0) << "a ball";
}

/// A row of pixels at 1 m, ten for each instance.
class Segments : public ::testing::Test {
 protected:
  Segments() {
    image_.frame.camera = {64, 8, 100, 100, 0, 0, {}};
    image_.instance = Image16{64, 8, std::vector<std::uint16_t>(64 * 8, 0)};
    for (int u = 0; u < 30; ++u) {
      cloud_.points_m.emplace_back(static_cast<float>(u) / 100, 0.0f, 1.0f);
      image_.instance->values[u] = static_cast<std::uint16_t>(1 + u / 10);
    }
    image_.truth = {{1, at(0), 0.9}, {1, at(0.1), 0.8}, {1, at(0.2), 0.3}};
  }
  static perception::Indices range(std::uint32_t begin, std::uint32_t end) {
    perception::Indices indices;
    for (std::uint32_t i = begin; i < end; ++i) indices.push_back(i);
    return indices;
  }
  SegmentationAccuracy measure(const std::vector<perception::Indices>& segments) {
    return segmentation_accuracy(cloud_, segments, image_);
  }
  perception::Cloud cloud_;
  BopImage image_;
};

TEST_F(Segments, ThatAreRightAreFound) {
  const auto accuracy = measure({range(0, 10), range(10, 20), range(20, 30)});
  EXPECT_EQ(accuracy.objects_n, 2) << "the third is hidden by more than half";
  EXPECT_EQ(accuracy.found_n, 2);
  EXPECT_EQ(accuracy.over_segmented_n, 0);
  EXPECT_EQ(accuracy.under_segmented_n, 0);
  EXPECT_EQ(accuracy.kept(), 1);
}

TEST_F(Segments, ThatHoldTwoObjectsAreUnderSegmented) {
  const auto accuracy = measure({range(0, 20)});
  EXPECT_EQ(accuracy.found_n, 2) << "IoU 10 / 20 with either";
  EXPECT_EQ(accuracy.under_segmented_n, 1);
  EXPECT_EQ(measure({range(0, 21)}).found_n, 0) << "IoU 10 / 21";
}

TEST_F(Segments, InPiecesAreOverSegmented) {
  const auto accuracy = measure({range(0, 4), range(4, 8), range(10, 20)});
  EXPECT_EQ(accuracy.found_n, 1) << "IoU 4 / 10";
  EXPECT_EQ(accuracy.over_segmented_n, 1);
  EXPECT_NEAR(accuracy.kept(), 18.0 / 30, 1e-9);
}

}  // namespace
}  // namespace graspd::eval
