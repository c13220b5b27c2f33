#include <gtest/gtest.h>

#include "block_scene.hpp"
#include "graspd/eval/accuracy.hpp"
#include "graspd/eval/pose_error.hpp"

namespace graspd::eval {
namespace {

using Eigen::Vector3d;

Eigen::Isometry3d at(double x_m, double yaw_rad = 0) {
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  T.translate(Vector3d(x_m, 0, 0.7));
  T.rotate(Eigen::AngleAxisd(yaw_rad, Vector3d::UnitZ()));
  return T;
}

class PoseError : public ::testing::Test {
 protected:
  parts::Part part_ = testing::block_part("block", {0.06, 0.04, 0.02});
};

TEST_F(PoseError, OfAShiftIsTheShift) {
  EXPECT_NEAR(mssd_m(part_, at(0.003), at(0)), 0.003, 1e-9);
  EXPECT_NEAR(mssd_m(part_, at(0), at(0)), 0, 1e-9);
}

TEST_F(PoseError, OfATurnIsTheFarthestCornersWay) {
  // Half the diagonal of 60 × 40 mm is 36.06 mm; turned by 180° a corner moves by 72.1 mm.
  EXPECT_NEAR(mssd_m(part_, at(0, M_PI), at(0)), 0.07211, 1e-5);
}

TEST_F(PoseError, ForgivesSymmetries) {
  Eigen::Isometry3d half_turn = Eigen::Isometry3d::Identity();
  half_turn.rotate(Eigen::AngleAxisd(M_PI, Vector3d::UnitZ()));
  part_.symmetries.discrete = {half_turn};
  EXPECT_EQ(all_symmetries(part_).size(), 2U);
  EXPECT_NEAR(mssd_m(part_, at(0, M_PI), at(0)), 0, 1e-6);
  part_.symmetries.continuous = {{Vector3d::UnitZ(), Vector3d::Zero()}};
  EXPECT_LT(mssd_m(part_, at(0, 1.234), at(0)), 0.01 * part_.diameter_m);
}

TEST_F(PoseError, CountsEachObjectOnceAndLeavesTheHiddenOut) {
  BopImage image;
  image.truth = {{1, at(0), 0.9}, {1, at(0.1), 0.6}, {1, at(0.2), 0.2}};
  std::vector<parts::Part> parts;
  parts.push_back(part_);
  const parts::Catalogue catalogue(std::move(parts));
  const auto result = [](double score, double x_m) {
    return BopResult{0, 0, 1, score, at(x_m), 0};
  };
  const PoseAccuracy accuracy = pose_accuracy(
      std::vector<BopResult>{result(0.9, 0.001),  // right
                             result(0.8, 0.002),  // the same object again: wrong
                             result(0.7, 0.2),    // right, but hardly visible: does not count
                             result(0.6, 0.5)},   // wrong
      image, catalogue);
  EXPECT_EQ(accuracy.objects_n, 2);
  EXPECT_EQ(accuracy.found_n, 1);
  EXPECT_EQ(accuracy.answers_n, 3);
  EXPECT_EQ(accuracy.right_n, 1);
  EXPECT_NEAR(accuracy.recall(), 0.5, 1e-9);
  EXPECT_NEAR(accuracy.precision(), 1.0 / 3, 1e-9);
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
