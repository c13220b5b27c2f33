#include <gtest/gtest.h>

#include "graspd/simulation/render.hpp"
#include "graspd/types/camera_model.hpp"
#include "sim_meshes.hpp"

namespace graspd::simulation {
namespace {

using testing::box_mesh;
using testing::sphere_mesh;
using testing::square_mesh;

const CameraIntrinsics kCamera{160, 120, 150, 148, 81.25, 57.5, {}};

Eigen::Vector3d ray(const CameraIntrinsics& camera, int u, int v) {
  return {(u - camera.cx_px) / camera.fx_px, (v - camera.cy_px) / camera.fy_px, 1};
}

Eigen::Isometry3d pose(const Eigen::Vector3d& t, double tilt_rad = 0,
                       const Eigen::Vector3d& axis = Eigen::Vector3d::UnitX()) {
  return Eigen::Translation3d(t) * Eigen::Isometry3d(Eigen::AngleAxisd(tilt_rad, axis));
}

template <class Visit>
void for_each_pixel(const Rendering& rendering, Visit visit) {
  for (int v = 0; v < rendering.camera.height_px; ++v) {
    for (int u = 0; u < rendering.camera.width_px; ++u) visit(u, v, rendering.index(u, v));
  }
}

TEST(SimRenderTest, ATiltedPlaneHasItsDepthAtEveryPixel) {
  const auto square = square_mesh(4, 40);
  for (const double tilt_rad : {0.0, 0.3, -0.9}) {
    const auto T = pose({0, 0, 0.8}, tilt_rad, Eigen::Vector3d(1, 0.4, 0).normalized());
    const SceneObject object{&square, T};
    const auto rendering = render(kCamera, {&object, 1});
    const Eigen::Vector3d normal = T.linear().col(2);
    int seen_n = 0;
    for_each_pixel(rendering, [&](int u, int v, std::size_t i) {
      const double z_m = normal.dot(T.translation()) / normal.dot(ray(kCamera, u, v));
      const Eigen::Vector3d p_square = T.inverse() * (ray(kCamera, u, v) * z_m);
      // Every pixel that meets the square, and none has a crack.
      if (z_m > 0 && p_square.head<2>().cwiseAbs().maxCoeff() < 1.999) {
        ASSERT_NEAR(rendering.z_m[i], z_m, 1e-5 * z_m) << u << " " << v;
        ++seen_n;
      }
    });
    EXPECT_GT(seen_n, 10000);
  }
}

TEST(SimRenderTest, ASphereHasItsDepthAtEveryPixel) {
  const double radius_m = 0.1;
  const Eigen::Vector3d centre_m(0.03, -0.02, 0.5);
  const auto sphere = sphere_mesh(radius_m);
  const SceneObject object{&sphere, pose(centre_m)};
  const auto rendering = render(kCamera, {&object, 1});
  const double sagitta_m = radius_m * (1 - std::cos(std::numbers::pi / 192));
  int seen_n = 0;
  for_each_pixel(rendering, [&](int u, int v, std::size_t i) {
    const Eigen::Vector3d d = ray(kCamera, u, v).normalized();
    const double nearest_m = d.dot(centre_m);
    const double half_m2 = radius_m * radius_m - (centre_m - nearest_m * d).squaredNorm();
    if (half_m2 < 0) {
      EXPECT_EQ(rendering.object[i], Rendering::kNothing);
    } else if (half_m2 > 0.25 * radius_m * radius_m) {  // within 60° of facing
      const double z_m = (nearest_m - std::sqrt(half_m2)) * d.z();
      ASSERT_NEAR(rendering.z_m[i], z_m, 4 * sagitta_m) << u << " " << v;
      const Eigen::Vector3f normal = rendering.facet_normals[std::size_t(rendering.facet[i])];
      const Eigen::Vector3d outwards = (d / d.z() * z_m - centre_m).normalized();
      EXPECT_GT(normal.cast<double>().dot(outwards), 0.999);
      ++seen_n;
    }
  });
  EXPECT_GT(seen_n, 1500);
}

TEST(SimRenderTest, TheNearerHidesTheFartherInAnyOrder) {
  const auto box = box_mesh({0.1, 0.1, 0.1});
  const SceneObject near{&box, pose({0, 0, 0.5})}, far{&box, pose({0.05, 0, 0.8})};
  const SceneObject near_first[] = {near, far}, far_first[] = {far, near};
  const auto a = render(kCamera, near_first), b = render(kCamera, far_first);
  EXPECT_EQ(a.z_m, b.z_m);
  for (std::size_t i = 0; i < a.object.size(); ++i) {
    EXPECT_EQ(a.object[i] < 0 ? -1 : 1 - a.object[i], b.object[i]);
  }
  EXPECT_EQ(a.object[a.index(81, 57)], 0);
  EXPECT_NEAR(a.z_m[a.index(81, 57)], 0.45, 1e-6);
}

TEST(SimRenderTest, WhatReachesBehindTheCameraIsCutOff) {
  const auto square = square_mesh(20);
  // A floor 1 m below the camera, from far behind it to far in front.
  const SceneObject floor{&square, pose({0, 1, 0}, std::numbers::pi / 2)};
  const auto rendering = render(kCamera, {&floor, 1});
  for_each_pixel(rendering, [&](int u, int v, std::size_t i) {
    const double down = ray(kCamera, u, v).y();
    if (down <= 0) {
      EXPECT_EQ(rendering.object[i], Rendering::kNothing);
    } else if (1 / down < 9) {
      EXPECT_NEAR(rendering.z_m[i], 1 / down, 1e-4 / down);
    }
  });
  const SceneObject behind{&square, pose({0, 0, -1})};
  const auto nothing = render(kCamera, {&behind, 1});
  EXPECT_EQ(std::count(nothing.object.begin(), nothing.object.end(), 0), 0);
}

TEST(SimRenderTest, VisibleFractionsOfHandMadeOcclusions) {
  const auto square = square_mesh(0.2);
  const auto half = box_mesh({0.1, 0.2, 0.001});
  // The principal point lies between pixels, so that half of the square is half of its pixels.
  const CameraIntrinsics camera{160, 120, 150, 150, 79.5, 59.5, {}};
  const SceneObject scene[] = {
      {&square, pose({0, 0, 0.6})},      // half of it behind …
      {&half, pose({0.05, 0, 0.5995})},  // … this
      {&square, pose({0, 0, 0.9})},      // wholly behind the first
      {&square, pose({0, 0, -1})},       // behind the camera
  };
  const auto fractions = visible_fractions(render(camera, scene), scene);
  ASSERT_EQ(fractions.size(), 4u);
  EXPECT_NEAR(fractions[0], 0.5, 0.02);
  EXPECT_EQ(fractions[1], 1);
  EXPECT_EQ(fractions[2], 0);
  EXPECT_EQ(fractions[3], 0);
}

TEST(SimRenderTest, DistortedPixelsLookAlongTheirOwnRays) {
  CameraIntrinsics camera{512, 424, 365.5, 365.5, 255, 205, {0.0905, -0.268, 0.002, -0.001, 0.095}};
  const auto ball = sphere_mesh(0.02, 24);
  for (const Eigen::Vector3d& centre_m :
       {Eigen::Vector3d(0.4, 0.3, 0.8), {-0.4, -0.35, 0.8}, {0, 0.3, 0.8}, {0.1, 0, 0.8}}) {
    const SceneObject object{&ball, pose(centre_m)};
    const auto rendering = render(camera, {&object, 1});
    Eigen::Vector2d sum(0, 0);
    int pixels_n = 0;
    for_each_pixel(rendering, [&](int u, int v, std::size_t i) {
      if (rendering.object[i] == Rendering::kNothing) return;
      sum += Eigen::Vector2d(u, v);
      ++pixels_n;
    });
    ASSERT_GT(pixels_n, 100);
    const Eigen::Vector2d expected = project(camera, centre_m);
    EXPECT_LT((sum / pixels_n - expected).norm(), 0.2) << centre_m.transpose();
  }
}

}  // namespace
}  // namespace graspd::simulation
