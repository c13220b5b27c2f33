/// The inner loops of the collision checks beside FCL and beside a ray at a time.
#include "graspd/perception/collision_kernel.hpp"

#include <gtest/gtest.h>

#include "block_scene.hpp"
#include "fcl_twin.hpp"
#include "graspd/parts/catalogue.hpp"
#include "kernel_pose.hpp"
#include "random_pose.hpp"

namespace graspd::perception {
namespace {

using Eigen::Vector3d;

bool meets(const parts::Part& part, const Eigen::Isometry3d& T_box_part, const Vector3d& half_m) {
  const parts::TriangleGroups& groups = part.triangles;
  const Eigen::Vector3f half = half_m.cast<float>();
  return meets_surface({{half.x(), half.y(), half.z()}}, kernel_pose(T_box_part),
                       {groups.corners_m.data(), groups.x_m.data(), groups.y_m.data(),
                        groups.z_m.data(), groups.radius_m.data(), groups.size()});
}

TEST(MeetsSurface, AgreesWithFclOnEveryPart) {
  const auto catalogue =
      parts::Catalogue::load(std::filesystem::path(GRASPD_SOURCE_DIR) / "deploy/parts");
  ASSERT_TRUE(catalogue) << catalogue.error().message;
  std::mt19937 random(3);
  std::uniform_real_distribution<double> size(0.002, 0.03);
  for (const parts::Part& part : catalogue->parts()) {
    const std::vector<PlacedPart> placed = {{&part, Eigen::Isometry3d::Identity()}};
    const testing::FclTwin twin(placed);
    int hits_n = 0;
    for (int i = 0; i < 400; ++i) {
      const Eigen::Isometry3d T_box_part = testing::random_pose(random, 1.5 * part.diameter_m);
      const Vector3d half_m(size(random), size(random), size(random));
      const auto fcl_meets = [&](double by_m) {
        const Vector3d grown_m = half_m + Vector3d::Constant(by_m);
        return twin.meets(0, T_box_part.inverse(), Eigen::AlignedBox3d(-grown_m, grown_m));
      };
      const bool expected = fcl_meets(0);
      hits_n += expected;
      if (meets(part, T_box_part, half_m) == expected) continue;
      // In float, a box that ends within a hundredth of a millimetre of the surface may go either
      // way.
      EXPECT_NE(fcl_meets(1e-5), fcl_meets(-1e-5)) << part.id << ", box " << i;
    }
    EXPECT_GT(hits_n, 40) << part.id;
    EXPECT_LT(hits_n, 360) << part.id;
  }
}

TEST(MeetsSurface, ABoxBesideAFaceOnlyTouchesIt) {
  const parts::Part block = testing::block_part("block", {0.1, 0.025, 0.025});
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  T.translation().y() = 0.0125 + 0.02;
  EXPECT_FALSE(meets(block, T, Vector3d(0.02, 0.0199, 0.02)));
  EXPECT_TRUE(meets(block, T, Vector3d(0.02, 0.0201, 0.02)));
}

class MeetsUnseen : public ::testing::Test {
 protected:
  static constexpr int kWidth = 64;
  static constexpr int kHeight = 48;
  static constexpr float kFocal = 80;

  FreeDepth image() {
    tile_free_m_.assign(kWidth * kHeight / 64, 1e9F);
    for (int i = 0; i < kWidth * kHeight; ++i) {
      float& least = tile_free_m_[(i / kWidth / 8) * (kWidth / 8) + i % kWidth / 8];
      least = std::min(least, free_m_[i]);
    }
    return {free_m_.data(), tile_free_m_.data(), kWidth, kHeight, kFocal, kFocal, 31.5F, 23.5F};
  }

  /// Each pixel's ray cut with the box, one at a time.
  bool expected(const Eigen::Isometry3d& T_box_camera, const Vector3d& half_m, double by_m) const {
    for (int v = 0; v < kHeight; ++v) {
      for (int u = 0; u < kWidth; ++u) {
        const Vector3d ray((u - 31.5) / kFocal, (v - 23.5) / kFocal, 1);
        const Vector3d d = T_box_camera.linear() * ray;
        double near = double{free_m_[v * kWidth + u]} + by_m;
        double far = 1e9;
        for (int axis = 0; axis < 3; ++axis) {
          const double a = (-half_m[axis] - T_box_camera.translation()[axis]) / d[axis];
          const double b = (half_m[axis] - T_box_camera.translation()[axis]) / d[axis];
          near = std::max(near, std::min(a, b));
          far = std::min(far, std::max(a, b));
        }
        if (near < far) return true;
      }
    }
    return false;
  }

  std::vector<float> free_m_ = std::vector<float>(kWidth * kHeight, 1.0F);
  std::vector<float> tile_free_m_;
};

TEST_F(MeetsUnseen, AgreesWithARayAtATime) {
  std::mt19937 random(5);
  std::uniform_real_distribution<float> depth_m(0.6F, 1.0F);
  std::uniform_real_distribution<double> size(0.01, 0.1);
  for (float& free_m : free_m_) free_m = depth_m(random);
  const FreeDepth seen = image();
  const TileBox all{0, 0, kWidth / 8, kHeight / 8};
  int hits_n = 0;
  for (int i = 0; i < 500; ++i) {
    Eigen::Isometry3d T_camera_box = testing::random_pose(random, 0.3);
    T_camera_box.pretranslate(Vector3d(0, 0, 0.6));
    const Vector3d half_m(size(random), size(random), size(random));
    double deepest_m = 0;
    for (int k = 0; k < 8; ++k) {
      const Vector3d corner = Eigen::AlignedBox3d(-half_m, half_m)
                                  .corner(static_cast<Eigen::AlignedBox3d::CornerType>(k));
      deepest_m = std::max(deepest_m, (T_camera_box * corner).z());
    }
    const Eigen::Isometry3d T_box_camera = T_camera_box.inverse();
    const Eigen::Vector3f half = half_m.cast<float>();
    const bool hit = meets_unseen(seen, {{half.x(), half.y(), half.z()}}, kernel_pose(T_box_camera),
                                  all, static_cast<float>(deepest_m), 0.005F);
    hits_n += hit;
    if (hit == expected(T_box_camera, half_m, 0.005)) continue;
    EXPECT_NE(expected(T_box_camera, half_m, 0.005 - 1e-5),
              expected(T_box_camera, half_m, 0.005 + 1e-5))
        << "box " << i;
  }
  EXPECT_GT(hits_n, 50);
  EXPECT_LT(hits_n, 450);
}

TEST_F(MeetsUnseen, OneNearReadingIsFoundWhereverItIs) {
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  T.translation().z() = -0.8;  // the camera is 0.8 m above the box
  const KernelBox box{{0.4F, 0.3F, 0.02F}};
  const TileBox all{0, 0, kWidth / 8, kHeight / 8};
  EXPECT_FALSE(meets_unseen(image(), box, kernel_pose(T), all, 0.82F, 0));
  for (const std::size_t pixel : {0U, 7U, 63U, 64U * 24 + 31, 64U * 48 - 1}) {
    free_m_[pixel] = 0.81F;
    EXPECT_TRUE(meets_unseen(image(), box, kernel_pose(T), all, 0.82F, 0)) << "pixel " << pixel;
    free_m_[pixel] = 1;
  }
}

}  // namespace
}  // namespace graspd::perception
