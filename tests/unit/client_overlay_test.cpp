#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <fstream>
#include <set>

#include "graspd/overlay/overlay.hpp"
#include "graspd/types/camera_model.hpp"

namespace graspd::overlay {
namespace {

using Rgb = std::array<std::uint8_t, 3>;

constexpr double kFloor_m = 0.75;
constexpr double kTop_m = 0.70;

/// A camera that looks straight down on a bin with bars in it, as a Kinect v2 would see them.
struct Scene {
  DepthFrame frame;
  PlanRequest request;
  PlanAnswer answer;
};

struct Bar {
  Eigen::Vector2d centre_base_m;
  double angle_rad;
};

constexpr double kHalfLength_m = 0.035;
constexpr double kHalfWidth_m = 0.009;

Eigen::Isometry3d T_base_bar(const Bar& bar) {
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  T.translation() << bar.centre_base_m, kFloor_m - kTop_m;
  T.linear() = Eigen::AngleAxisd(bar.angle_rad, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  return T;
}

/// Fingers across the bar, approaching from above.
Eigen::Isometry3d T_base_grasp(const Bar& bar) {
  Eigen::Isometry3d T = T_base_bar(bar);
  const Eigen::Vector3d closing = T.linear().col(1);
  const Eigen::Vector3d approach = -Eigen::Vector3d::UnitZ();
  T.linear().col(0) = closing;
  T.linear().col(1) = approach.cross(closing);
  T.linear().col(2) = approach;
  return T;
}

Scene scene(const std::vector<Bar>& bars) {
  Scene scene;
  CameraIntrinsics& camera = scene.frame.camera;
  camera = {512, 424, 365.5, 365.5, 255, 205, {0.09, -0.27, 0, 0, 0.09}};
  Eigen::Isometry3d& T_base_camera = scene.request.T_base_camera;
  T_base_camera.linear() = Eigen::Vector3d(1, -1, -1).asDiagonal();
  T_base_camera.translation() << 0, 0, kFloor_m;
  scene.request.bin = Bin{Eigen::Isometry3d::Identity(), {0.4, 0.3, 0.1}, 0.003};
  scene.request.parts = {{"bar", 0}};

  for (int v = 0; v < camera.height_px; ++v) {
    for (int u = 0; u < camera.width_px; ++u) {
      const Eigen::Vector3d ray = ray_through(camera, u, v);
      double z_m = kFloor_m;
      for (const Bar& bar : bars) {
        const Eigen::Vector3d p_bar = T_base_bar(bar).inverse() * T_base_camera * (kTop_m * ray);
        if (std::abs(p_bar.x()) < kHalfLength_m && std::abs(p_bar.y()) < kHalfWidth_m) z_m = kTop_m;
      }
      const Eigen::Vector3d p_base = T_base_camera * (z_m * ray);
      const bool in_bin = std::abs(p_base.x()) < 0.2 && std::abs(p_base.y()) < 0.15;
      if (!in_bin) z_m = 2.5;                    // a floor far below the bin
      if (u < 12 || (u + v) % 97 == 0) z_m = 0;  // drop-outs
      scene.frame.depth.push_back(static_cast<std::uint16_t>(std::lround(z_m * 1000)));
    }
  }
  for (std::size_t i = 0; i < bars.size(); ++i) {
    Object object;
    object.id = static_cast<std::uint32_t>(i);
    object.part_id = "bar";
    object.T_base_part = T_base_bar(bars[i]);
    for (const auto& [x, y] : {std::pair{-1, -1}, {1, -1}, {1, 1}, {-1, 1}}) {
      const Eigen::Vector3d p_camera =
          T_base_camera.inverse() *
          (object.T_base_part * Eigen::Vector3d(x * kHalfLength_m, y * kHalfWidth_m, 0));
      const Eigen::Vector2d pixel = project(camera, p_camera);
      object.outline_px.push_back(static_cast<float>(pixel.x()));
      object.outline_px.push_back(static_cast<float>(pixel.y()));
    }
    scene.answer.objects.push_back(object);
    Grasp grasp;
    grasp.object_id = object.id;
    grasp.T_base_grasp = T_base_grasp(bars[i]);
    grasp.opening_width_m = 2 * kHalfWidth_m + 0.01;
    scene.answer.grasps.push_back(grasp);
  }
  return scene;
}

Scene three_bars() {
  return scene({{{0.05, 0.03}, 0.4}, {{-0.08, 0.02}, -0.9}, {{-0.02, -0.07}, 1.5}});
}

/// Where a point of the grasp frame is in the picture.
std::pair<int, int> pixel_of(const Scene& scene, const Grasp& grasp, double x_m, double y_m) {
  const Eigen::Vector3d p_camera =
      scene.request.T_base_camera.inverse() * grasp.T_base_grasp * Eigen::Vector3d(x_m, y_m, 0);
  const Eigen::Vector2d pixel = project(scene.frame.camera, p_camera);
  const View view = view_of(scene.frame, scene.request);
  return {static_cast<int>(std::lround(view.x(pixel.x()))),
          static_cast<int>(std::lround(view.y(pixel.y())))};
}

std::size_t count(const RgbImage& image, const Rgb& color) {
  return static_cast<std::size_t>(std::count(image.pixels.begin(), image.pixels.end(), color));
}

TEST(Overlay, JawsAreWhereTheCameraSeesThem) {
  const Scene scene = three_bars();
  const RgbImage image = draw(scene.frame, scene.request, scene.answer);
  for (std::size_t rank = 0; rank < scene.answer.grasps.size(); ++rank) {
    const Grasp& grasp = scene.answer.grasps[rank];
    const double jaw_m = grasp.opening_width_m / 2 + scene.request.gripper.jaw_size_m.x() / 2;
    for (const double side : {-1.0, 1.0}) {
      const auto [x, y] = pixel_of(scene, grasp, side * jaw_m, 0.005);
      EXPECT_EQ(image.at(x, y), rank == 0 ? kBestGraspColor : kGraspColor)
          << "rank " << rank + 1 << ", side " << side;
    }
  }
}

TEST(Overlay, ContrastIsThatOfTheBin) {
  const Scene scene = three_bars();
  const RgbImage image = draw(scene.frame, scene.request, {});
  const Bar bar{{0.05, 0.03}, 0.4};
  Grasp at_bar;
  at_bar.T_base_grasp = T_base_grasp(bar);
  const auto [x, y] = pixel_of(scene, at_bar, 0, 0.01);
  const Rgb part = image.at(x, y);
  const View view = view_of(scene.frame, scene.request);
  const auto at = [&](double u_px, double v_px) {
    return image.at(static_cast<int>(view.x(u_px)), static_cast<int>(view.y(v_px)));
  };
  const Rgb floor = at(255, 160);
  const Rgb outside = at(255, view.top_px + 1);
  EXPECT_GT(part[0], floor[0] + 120) << "5 cm of part against 1.75 m of drop beside the bin";
  EXPECT_LE(outside[0], floor[0]);
  EXPECT_EQ(at(291, 194), kNoReadingColor) << "a drop-out";
}

TEST(Overlay, ShowsTheBinLargeAndTheWholeImageWhereThereIsNone) {
  Scene scene = three_bars();
  View view = view_of(scene.frame, scene.request);
  EXPECT_LT(view.width_px, 260) << "0.4 m of bin at 0.75 m are 195 pixels";
  EXPECT_GE(view.scale, 4);
  for (const Object& object : scene.answer.objects) {
    for (std::size_t i = 0; i < object.outline_px.size(); i += 2) {
      EXPECT_GT(object.outline_px[i], view.left_px);
      EXPECT_LT(object.outline_px[i], view.left_px + view.width_px);
    }
  }
  scene.request.bin.reset();
  view = view_of(scene.frame, scene.request);
  EXPECT_GT(view.width_px, 490);
  EXPECT_EQ(view.scale, 2);
}

TEST(Overlay, EachObjectHasItsOutline) {
  Scene scene = three_bars();
  scene.answer.grasps.clear();
  const RgbImage with = draw(scene.frame, scene.request, scene.answer);
  for (Object& object : scene.answer.objects) {
    const auto outline = object.outline_px;
    object.outline_px.clear();
    const RgbImage without = draw(scene.frame, scene.request, scene.answer);
    // Halfway between the first two corners.
    const View view = view_of(scene.frame, scene.request);
    const int x = static_cast<int>(view.x((outline[0] + outline[2]) / 2));
    const int y = static_cast<int>(view.y((outline[1] + outline[3]) / 2));
    EXPECT_NE(with.at(x, y), without.at(x, y)) << "object " << object.id;
    object.outline_px = outline;
  }
}

TEST(Overlay, OnlyTheBestGraspOfAnObjectIsDrawn) {
  Scene scene = three_bars();
  const RgbImage once = draw(scene.frame, scene.request, scene.answer);
  Grasp worse = scene.answer.grasps[0];
  worse.T_base_grasp.translation() += Eigen::Vector3d(0.02, 0.02, 0);
  scene.answer.grasps.push_back(worse);
  const RgbImage again = draw(scene.frame, scene.request, scene.answer);
  const View view = view_of(scene.frame, scene.request);
  for (int y = 0; y < view.height_px * view.scale; ++y) {
    for (int x = 0; x < once.width_px; ++x) ASSERT_EQ(once.at(x, y), again.at(x, y));
  }
}

TEST(Overlay, AnAnswerWithNothingInItHasNoGraspButItsReason) {
  Scene scene = three_bars();
  PlanAnswer empty;
  empty.outcome = Outcome::kBinEmpty;
  const RgbImage without = draw(scene.frame, scene.request, empty);
  empty.reason = "No point is more than 6 mm above the bin's floor. " + std::string(300, 'x');
  const RgbImage with = draw(scene.frame, scene.request, empty);
  EXPECT_GT(with.height_px, without.height_px) << "the reason has its own lines";
  const RgbImage planned = draw(scene.frame, scene.request, scene.answer);
  EXPECT_GT(count(planned, kBestGraspColor), count(without, kBestGraspColor));
}

TEST(Overlay, OutlinesThatLeaveTheImageAndOddNumbersOfCoordinatesDoNoHarm) {
  Scene scene = three_bars();
  scene.answer.objects[0].outline_px = {-500, -500, 5000, 200, 100, 9000, 7};
  scene.answer.grasps[0].T_base_grasp.translation().z() = 2;  // behind the camera
  const RgbImage image = draw(scene.frame, scene.request, scene.answer);
  EXPECT_EQ(image.pixels.size(), static_cast<std::size_t>(image.width_px * image.height_px));
}

TEST(Overlay, WritesAPngThatIsNamedWhereItCannot) {
  const Scene scene = three_bars();
  const RgbImage image = draw(scene.frame, scene.request, scene.answer);
  // GRASPD_KEEP keeps the picture for people to look at.
  const char* keep = std::getenv("GRASPD_KEEP");
  const std::filesystem::path path =
      std::filesystem::path(keep ? keep : ::testing::TempDir()) / "overlay_test.png";
  ASSERT_TRUE(write_png(path, image));
  std::string signature(8, '\0');
  std::ifstream(path).read(signature.data(), 8);
  EXPECT_EQ(signature, "\x89PNG\r\n\x1a\n");
  if (!keep) std::filesystem::remove(path);

  const auto refused = write_png("/nowhere/at/all.png", image);
  ASSERT_FALSE(refused);
  EXPECT_NE(refused.error().message.find("/nowhere/at/all.png"), std::string::npos);
}

}  // namespace
}  // namespace graspd::overlay
