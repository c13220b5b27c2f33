#include <gtest/gtest.h>

#include "graspd/simulation/kinect_v2.hpp"
#include "sim_meshes.hpp"

namespace graspd::simulation {
namespace {

using testing::box_mesh;
using testing::square_mesh;

KinectV2Parameters perfect() {
  KinectV2Parameters sensor;
  sensor.camera = {160, 120, 365.5, 365.5, 80, 60, {}};
  sensor.blur_sigma_px = 0;
  sensor.lateral_sigma_m = 0;
  sensor.axial_scale = 0;
  sensor.grazing_drop_out = 0;
  return sensor;
}

Eigen::Isometry3d at(double z_m, double tilt_rad = 0) {
  return Eigen::Translation3d(0, 0, z_m) *
         Eigen::Isometry3d(Eigen::AngleAxisd(tilt_rad, Eigen::Vector3d::UnitY()));
}

/// z of the tilted plane of `at` at a pixel.
double plane_m(const KinectV2Parameters& sensor, double z_m, double tilt_rad, int u) {
  const double x = (u - sensor.camera.cx_px) / sensor.camera.fx_px;
  return z_m / (1 + x * std::tan(tilt_rad));
}

class SimKinectV2Test : public ::testing::Test {
 protected:
  DepthFrame see_plane(const KinectV2Parameters& sensor, double z_m, double tilt_rad = 0,
                       double gloss = 0, std::uint64_t seed = 1) const {
    const SceneObject plane{&square, at(z_m, tilt_rad), gloss};
    return observe({&plane, 1}, sensor, seed);
  }

  static double empty_share(const DepthFrame& frame) {
    return double(std::count(frame.depth.begin(), frame.depth.end(), 0)) /
           double(frame.depth.size());
  }

  const parts::Mesh square = square_mesh(20);
};

TEST_F(SimKinectV2Test, WithoutItsErrorsItRoundsTheTruth) {
  const KinectV2Parameters sensor = perfect();
  for (const double tilt_rad : {0.0, 0.7}) {
    const DepthFrame frame = see_plane(sensor, 0.8, tilt_rad);
    for (int v = 0; v < 120; ++v) {
      for (int u = 0; u < 160; ++u) {
        ASSERT_NEAR(frame.at(u, v), 1e3 * plane_m(sensor, 0.8, tilt_rad, u), 0.51) << u;
      }
    }
  }
}

struct NoiseCase {
  double z_m;
  double incidence_rad;
  double sigma_mm;  ///< by hand from Fankhauser's formula
};

TEST(SimKinectV2FormulaTest, AxialSigmaIsFankhausers) {
  // 1.5 − 0.5 z + 0.3 z² + 0.1 z^1.5 θ² / (π/2 − θ)²
  for (const NoiseCase& c : {NoiseCase{0.7, 0, 1.297},
                             {1, 0, 1.3},
                             {2, 0, 1.7},
                             {1, std::numbers::pi / 4, 1.4},
                             {4, std::numbers::pi / 4, 5.1}}) {
    EXPECT_NEAR(1e3 * axial_sigma_m(c.z_m, c.incidence_rad), c.sigma_mm, 1e-3) << c.z_m;
  }
  const double at_80 = axial_sigma_m(1, 80 * std::numbers::pi / 180);
  EXPECT_EQ(axial_sigma_m(1, 1.57), at_80);
  EXPECT_NEAR(1e3 * at_80, 1.3 + 0.1 * 64, 1e-3);
}

TEST_F(SimKinectV2Test, TheNoiseOnAPlaneIsTheFormulas) {
  for (const double blur_px : {0.0, 0.9}) {
    KinectV2Parameters sensor = perfect();
    sensor.axial_scale = 1;
    sensor.blur_sigma_px = blur_px;
    for (const double z_m : {0.7, 1.5, 3.0}) {
      for (const double tilt_rad : {0.0, 1.0}) {
        const DepthFrame frame = see_plane(sensor, z_m, tilt_rad);
        double squares_mm2 = 0;
        int pixels_n = 0;
        for (int v = 10; v < 110; ++v) {
          for (int u = 70; u < 90; ++u) {  // narrow: the ray's angle changes with u
            const double error_mm = frame.at(u, v) - 1e3 * plane_m(sensor, z_m, tilt_rad, u);
            squares_mm2 += error_mm * error_mm;
            ++pixels_n;
          }
        }
        const double sigma_mm = 1e3 * axial_sigma_m(z_m, tilt_rad);
        const double rounding_mm = 1 / std::sqrt(12.0);
        EXPECT_NEAR(std::sqrt(squares_mm2 / pixels_n), std::hypot(sigma_mm, rounding_mm),
                    0.08 * sigma_mm)
            << z_m << " m, " << tilt_rad << " rad, blur " << blur_px;
      }
    }
  }
}

TEST_F(SimKinectV2Test, BlurMakesTheNoiseOfNeighboursAlike) {
  const auto correlation = [this](double blur_px) {
    KinectV2Parameters sensor = perfect();
    sensor.axial_scale = 5;
    sensor.blur_sigma_px = blur_px;
    const DepthFrame frame = see_plane(sensor, 1);
    double products = 0, squares = 0;
    for (int v = 5; v < 115; ++v) {
      for (int u = 5; u < 155; ++u) {
        products += (frame.at(u, v) - 1000.0) * (frame.at(u + 1, v) - 1000.0);
        squares += (frame.at(u, v) - 1000.0) * (frame.at(u, v) - 1000.0);
      }
    }
    return products / squares;
  };
  EXPECT_NEAR(correlation(0), 0, 0.03);
  // Of white noise under a Gaussian of sigma s, at distance 1: exp(−1 / 4 s²).
  EXPECT_NEAR(correlation(0.9), std::exp(-1 / (4 * 0.81)), 0.04);
}

class SimKinectV2StepTest : public SimKinectV2Test {
 protected:
  /// A box's edge at u = 80.3 in front of a plane.
  DepthFrame see_step(const KinectV2Parameters& sensor, double step_m) const {
    const auto box = box_mesh({1, 1, step_m});
    const double front_m = 1 - step_m;
    const double edge_m = 0.3 / sensor.camera.fx_px * front_m;
    const SceneObject scene[] = {
        {&square, at(1)},
        {&box, Eigen::Isometry3d(Eigen::Translation3d(edge_m - 0.5, 0, 1 - step_m / 2))}};
    return observe(scene, sensor, 1);
  }
};

TEST_F(SimKinectV2StepTest, PixelsOnAnEdgeFlyBetweenFrontAndBack) {
  const DepthFrame frame = see_step(perfect(), 0.06);
  EXPECT_EQ(frame.at(70, 60), 940);
  EXPECT_EQ(frame.at(90, 60), 1000);
  int flying_n = 0;
  for (int u = 70; u < 90; ++u) {
    EXPECT_GE(frame.at(u + 1, 60), frame.at(u, 60));
    flying_n += frame.at(u, 60) > 945 && frame.at(u, 60) < 995;
  }
  EXPECT_EQ(flying_n, 1);

  KinectV2Parameters blurred = perfect();
  blurred.blur_sigma_px = 0.9;
  const DepthFrame softer = see_step(blurred, 0.06);
  int softer_n = 0;
  for (int u = 70; u < 90; ++u) softer_n += softer.at(u, 60) > 945 && softer.at(u, 60) < 995;
  EXPECT_GE(softer_n, 2);
}

TEST_F(SimKinectV2StepTest, TheEdgeFilterTakesOnlyHighSteps) {
  const DepthFrame low = see_step(perfect(), 0.09), high = see_step(perfect(), 0.12);
  EXPECT_EQ(empty_share(low), 0);
  int empty_n = 0;
  for (int u = 0; u < 160; ++u) empty_n += high.at(u, 60) == 0;
  EXPECT_GE(empty_n, 1);
  EXPECT_LE(empty_n, 3);
}

TEST_F(SimKinectV2Test, AFloorBendsUpTowardsTheWalls) {
  KinectV2Parameters sensor = perfect();
  sensor.wall_bow_m = 0.012;
  sensor.wall_reach_m = 0.05;
  const SceneObject scene[] = {{&square, at(0.75)}};
  const Walls walls{at(0.75) * Eigen::AngleAxisd(std::numbers::pi, Eigen::Vector3d::UnitX()),
                    {0.2, 1, 0.1}};
  const DepthFrame bent = observe(scene, sensor, 1, &walls);
  const auto at_distance_m = [&](double distance_m) {
    const double x_px = sensor.camera.fx_px * (0.1 - distance_m) / 0.75;
    return bent.at(int(std::lround(sensor.camera.cx_px + x_px)), 60);
  };
  EXPECT_EQ(at_distance_m(0.07), 750);
  EXPECT_NEAR(at_distance_m(0.025), 747, 1) << "half way: a quarter of the bow";
  EXPECT_NEAR(at_distance_m(0.001), 738.5, 1);
  EXPECT_EQ(at_distance_m(-0.01), 750) << "beyond the wall";
}

TEST_F(SimKinectV2Test, GlossAndGrazingLoseReadings) {
  KinectV2Parameters sensor = perfect();
  EXPECT_EQ(empty_share(see_plane(sensor, 1, 0.3)), 0);
  EXPECT_EQ(empty_share(see_plane(sensor, 1, 1.2)), 0) << "matt, and nothing lost by grazing";

  // Seen straight on, a polished plane blinds the pixels about the foot of the perpendicular.
  const DepthFrame mirror = see_plane(sensor, 1, 0, 1);
  EXPECT_EQ(mirror.at(80, 60), 0);
  EXPECT_GT(mirror.at(140, 60), 0);
  const double some = empty_share(see_plane(sensor, 1, 1.2, 0.3));
  EXPECT_NEAR(some, 0.3 * (1.2 * 180 / std::numbers::pi - 40) / 40, 0.03);

  sensor.grazing_drop_out = 0.5;
  const DepthFrame grazing = see_plane(sensor, 1, 1.483);  // 85° at the middle of the image
  int empty_n = 0;
  for (int v = 0; v < 120; ++v) {
    for (int u = 76; u < 85; ++u) empty_n += grazing.at(u, v) == 0;
  }
  EXPECT_NEAR(empty_n / (9.0 * 120), 0.25, 0.05);
}

TEST_F(SimKinectV2Test, ReadsWithinItsRangeOnly) {
  const KinectV2Parameters sensor = perfect();
  EXPECT_EQ(empty_share(see_plane(sensor, 0.49)), 1);
  EXPECT_EQ(empty_share(see_plane(sensor, 0.51)), 0);
  EXPECT_EQ(empty_share(see_plane(sensor, 4.49)), 0);
  EXPECT_EQ(empty_share(see_plane(sensor, 4.51)), 1);
  EXPECT_EQ(empty_share(observe({}, sensor, 1)), 1);
}

TEST_F(SimKinectV2Test, TheDeviceOffsetShiftsEveryReading) {
  KinectV2Parameters sensor = perfect();
  sensor.device_offset_m = 0.013;
  for (const std::uint16_t z : see_plane(sensor, 1).depth) ASSERT_EQ(z, 1013);
}

TEST_F(SimKinectV2Test, TheSeedMakesTheFrame) {
  KinectV2Parameters sensor;
  sensor.camera = perfect().camera;
  const auto a = see_plane(sensor, 1, 0.5, 0, 1);
  EXPECT_EQ(see_plane(sensor, 1, 0.5, 0, 1).depth, a.depth);
  EXPECT_NE(see_plane(sensor, 1, 0.5, 0, 2).depth, a.depth);
}

TEST_F(SimKinectV2Test, EachLookAtAStillSceneIsAFrameOfItsOwn) {
  KinectV2Parameters sensor;
  sensor.camera = perfect().camera;
  const SceneObject plane{&square, at(0.8, 0.3)};
  const StillScene scene({&plane, 1}, sensor, std::nullopt);
  EXPECT_EQ(scene.look(1).depth, observe({&plane, 1}, sensor, 1).depth);
  EXPECT_EQ(scene.look(2).depth, observe({&plane, 1}, sensor, 2).depth);
  EXPECT_NE(scene.look(1).depth, scene.look(2).depth);
}

}  // namespace
}  // namespace graspd::simulation
