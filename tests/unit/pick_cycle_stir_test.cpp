#include <gmock/gmock.h>

#include <numbers>

#include "graspd/agent/stir.hpp"
#include "graspd/agent/surroundings.hpp"
#include "graspd/types/camera_model.hpp"

namespace graspd::agent {
namespace {

using ::testing::IsEmpty;
using ::testing::SizeIs;

Bin turned_bin() {
  Bin bin{Eigen::Isometry3d::Identity(), {0.3, 0.2, 0.1}, 0.002};
  bin.T_base_bin.translate(Eigen::Vector3d(0.4, -0.1, 0.05));
  bin.T_base_bin.rotate(Eigen::AngleAxisd(0.6, Eigen::Vector3d::UnitZ()));
  return bin;
}

/// A floor with a cone of 4 cm on it.
Surroundings heap_at(const Bin& bin, double x_m, double y_m) {
  Surroundings surroundings{bin, {}};
  for (int i = -49; i <= 49; ++i) {
    for (int j = -32; j <= 32; ++j) {
      const Eigen::Vector2d p_m(0.003 * i, 0.003 * j);
      const double far_m = (p_m - Eigen::Vector2d(x_m, y_m)).norm();
      const double z_m = std::max(0.0, 0.04 - 0.8 * far_m);
      surroundings.p_base_m.push_back(
          (bin.T_base_bin * Eigen::Vector3d(p_m.x(), p_m.y(), z_m)).cast<float>());
    }
  }
  return surroundings;
}

Eigen::Vector3d in_bin(const Bin& bin, const Motion& motion) {
  return bin.T_base_bin.inverse() * motion.T_base_grasp.translation();
}

/// How far point p is from the line from a to b.
double distance_to_line(const Eigen::Vector3d& p, const Eigen::Vector3d& a,
                        const Eigen::Vector3d& b) {
  return (p - a).cross(b - a).norm() / (b - a).norm();
}

TEST(StirTest, StrokesGoThroughTheTopOfThePileSlowlyAndStayInTheBin) {
  const Bin bin = turned_bin();
  const graspd::Gripper gripper;
  const StirOptions options;
  const auto ways = strokes(heap_at(bin, 0.03, -0.02), gripper, options);
  ASSERT_THAT(ways, SizeIs(4));
  for (const Stroke& stroke : ways) {
    const Eigen::Vector3d from_m = in_bin(bin, stroke[1]);
    const Eigen::Vector3d to_m = in_bin(bin, stroke[2]);
    EXPECT_NEAR(from_m.z(), 0.04 - options.depth_m, 0.005);
    EXPECT_NEAR(to_m.z(), from_m.z(), 1e-9);
    EXPECT_LE((to_m - from_m).norm(), options.stroke_m + 1e-9);
    EXPECT_LT(distance_to_line({0.03, -0.02, from_m.z()}, from_m, to_m), 0.02);
    for (const Eigen::Vector3d& p_m : {from_m, to_m}) {
      EXPECT_LT(std::abs(p_m.x()) + gripper.palm_size_m.x() / 2, bin.inner_size_m.x() / 2);
      EXPECT_LT(std::abs(p_m.y()) + gripper.palm_size_m.y() / 2, bin.inner_size_m.y() / 2);
    }
    for (const Motion& motion : {stroke[0], stroke[3]}) {
      EXPECT_GT(in_bin(bin, motion).z(), bin.inner_size_m.z()) << "above the rim";
      EXPECT_LE(in_bin(bin, motion).z(), from_m.z() + gripper.retreat_m);
    }
    EXPECT_EQ(stroke[0].path, Path::kFree);
    EXPECT_EQ(stroke[2].path, Path::kStraight);
    EXPECT_EQ(stroke[1].speed_share, options.speed_share);
    EXPECT_EQ(stroke[2].speed_share, options.speed_share);
    EXPECT_TRUE(stroke[2].T_base_grasp.linear().col(2).isApprox(-Eigen::Vector3d::UnitZ()));
  }
}

TEST(StirTest, FirstComesDownBesideWhatLiesThere) {
  const Bin bin = turned_bin();
  Surroundings surroundings = heap_at(bin, 0, 0);
  // Higher than the tips, where the strokes along x and one of those along y begin.
  for (const Eigen::Vector2d& at_m : {Eigen::Vector2d(0.05, 0), {-0.05, 0}, {0, 0.05}}) {
    for (int i = -4; i <= 4; ++i) {
      for (int j = -4; j <= 4; ++j) {
        const Eigen::Vector3d p_m(at_m.x() + 0.003 * i, at_m.y() + 0.003 * j, 0.03);
        surroundings.p_base_m.push_back((bin.T_base_bin * p_m).cast<float>());
      }
    }
  }
  graspd::Gripper gripper;
  gripper.palm_size_m.y() = 0.06;
  gripper.jaw_size_m.z() = 0.12;
  const auto ways = strokes(surroundings, gripper, {});
  ASSERT_THAT(ways, SizeIs(4)) << "where one does not help the next may";
  EXPECT_LT(in_bin(bin, ways[0][1]).y(), -0.03);
}

TEST(StirTest, LongJawsGetToTheWallWhereThePalmStaysAboveTheRim) {
  const Bin bin = turned_bin();
  const Surroundings heap = heap_at(bin, 0.12, -0.07);
  const auto farthest_m = [&](double jaw_m) {
    graspd::Gripper gripper;
    gripper.jaw_size_m.z() = jaw_m;
    Eigen::Vector2d extent_m = Eigen::Vector2d::Zero();
    for (const Stroke& stroke : strokes(heap, gripper, {})) {
      for (const Motion& motion : stroke) {
        extent_m = extent_m.cwiseMax(in_bin(bin, motion).head<2>().cwiseAbs());
      }
    }
    return extent_m;
  };
  const Eigen::Vector2d half_m = bin.inner_size_m.head<2>() / 2;
  const graspd::Gripper gripper;
  const Eigen::Vector2d with_palm_m = half_m - farthest_m(0.05);
  EXPECT_GE(with_palm_m.x(), gripper.palm_size_m.x() / 2);
  EXPECT_GE(with_palm_m.y(), gripper.palm_size_m.y() / 2);
  const Eigen::Vector2d jaws_alone_m = half_m - farthest_m(0.11);
  EXPECT_GE(jaws_alone_m.x(), gripper.jaw_size_m.x());
  EXPECT_GE(jaws_alone_m.y(), gripper.jaw_size_m.y() / 2);
  EXPECT_LT(jaws_alone_m.maxCoeff(), 0.02);
}

TEST(StirTest, NeverScratchesTheFloor) {
  const Bin bin = turned_bin();
  StirOptions options;
  options.depth_m = 0.2;
  for (const Stroke& stroke : strokes(heap_at(bin, 0, 0), {}, options)) {
    for (const Motion& motion : stroke) EXPECT_GE(in_bin(bin, motion).z(), 0.01 - 1e-9);
  }
}

TEST(StirTest, AFlyingPixelIsNoPile) {
  const Bin bin = turned_bin();
  Surroundings surroundings = heap_at(bin, 0.03, -0.02);
  surroundings.p_base_m.push_back(
      (bin.T_base_bin * Eigen::Vector3d(-0.05, 0.03, 0.2)).cast<float>());
  for (const Stroke& stroke : strokes(surroundings, {}, {})) {
    EXPECT_LT(in_bin(bin, stroke[2]).z(), 0.04);
  }
}

TEST(StirTest, WithoutBinOrReadingsOrRoomThereIsNone) {
  const Bin bin = turned_bin();
  Surroundings surroundings = heap_at(bin, 0, 0);
  graspd::Gripper wide;
  wide.palm_size_m.y() = 0.19;
  EXPECT_THAT(strokes(surroundings, wide, {}), IsEmpty());
  EXPECT_THAT(strokes({bin, {}}, {}, {}), IsEmpty());
  surroundings.bin.reset();
  EXPECT_THAT(strokes(surroundings, {}, {}), IsEmpty());
}

class SurveyTest : public ::testing::Test {
 protected:
  SurveyTest() {
    frame.camera = {64, 48, 60, 60, 31, 24, {0.09, -0.27, 0, 0, 0.09}};
    frame.depth.assign(64 * 48, 800);
    frame.depth[0] = 0;
    request.T_base_camera.translate(Eigen::Vector3d(0.3, 0.1, 0.8));
    request.T_base_camera.rotate(
        Eigen::AngleAxisd(std::numbers::pi - 0.1, Eigen::Vector3d::UnitX()));
  }
  Eigen::Vector3d p_base_m(int u, int v) const {
    return request.T_base_camera * (0.8 * ray_through(frame.camera, u, v));
  }

  DepthFrame frame;
  PlanRequest request;
  Surveyor surveyor;
};

TEST_F(SurveyTest, WithoutABinEveryReadingIsInTheWay) {
  const auto surroundings = surveyor.survey(frame, request);
  EXPECT_FALSE(surroundings.bin);
  ASSERT_THAT(surroundings.p_base_m, SizeIs(64 * 48 - 1));
  EXPECT_LT((surroundings.p_base_m[0].cast<double>() - p_base_m(1, 0)).norm(), 1e-5);
}

TEST_F(SurveyTest, OnlyWhatIsInTheBinOrNearItIsInTheWay) {
  request.bin = Bin{Eigen::Isometry3d(Eigen::Translation3d(p_base_m(31, 24))), {0.2, 0.1, 0.1}, 0};
  const auto surroundings = surveyor.survey(frame, request);
  ASSERT_TRUE(surroundings.bin);
  std::size_t near_n = 0;
  for (int v = 0; v < 48; ++v) {
    for (int u = 0; u < 64; ++u) {
      const Eigen::Vector3d p_bin_m = request.bin->T_base_bin.inverse() * p_base_m(u, v);
      near_n += std::abs(p_bin_m.x()) <= 0.2 && std::abs(p_bin_m.y()) <= 0.15 &&
                p_bin_m.z() >= -0.1 && p_bin_m.z() <= 0.2;
    }
  }
  EXPECT_GT(near_n, 100u);
  EXPECT_LT(near_n, 1000u);
  EXPECT_THAT(surroundings.p_base_m, SizeIs(near_n));
}

TEST_F(SurveyTest, AnotherCameraHasOtherRays) {
  surveyor.survey(frame, request);
  frame.camera.fx_px = 90;
  EXPECT_LT((surveyor.survey(frame, request).p_base_m[0].cast<double>() - p_base_m(1, 0)).norm(),
            1e-5);
}

TEST_F(SurveyTest, TheCropBoxIsTheWorkspaceWhereThereIsNoBin) {
  request.crop_box =
      CropBox{Eigen::Isometry3d(Eigen::Translation3d(p_base_m(31, 24))), {0.1, 0.1, 0.1}};
  for (const Eigen::Vector3f& p_m : surveyor.survey(frame, request).p_base_m) {
    EXPECT_LT((p_m.cast<double>() - p_base_m(31, 24)).cwiseAbs().maxCoeff(), 0.05 + 1e-6);
  }
}

}  // namespace
}  // namespace graspd::agent
