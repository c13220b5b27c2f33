#include "graspd/parts/registration_model.hpp"

#include <gtest/gtest.h>

#include <random>

#include "block_scene.hpp"
#include "graspd/parts/part.hpp"

namespace graspd::parts {
namespace {

using Eigen::Vector3f;

class EveryModel : public ::testing::TestWithParam<const char*> {
 protected:
  EveryModel() {
    const std::filesystem::path folder =
        std::filesystem::path(GRASPD_SOURCE_DIR) / "deploy/parts" / GetParam();
    part_ = make_part(*read_part_file(folder / "part.yaml")).value();
  }
  Part part_;
};

TEST_P(EveryModel, ViewsShowOnlyWhatFacesTheCamera) {
  const RegistrationModel& model = part_.registration;
  ASSERT_FALSE(model.views().empty());
  float largest_share = 0;
  for (const View& view : model.views()) {
    largest_share = std::max(largest_share, view.area_share);
    ASSERT_GE(view.points_n, 20U);
    for (std::uint32_t i = view.first; i < view.first + view.points_n; ++i) {
      EXPECT_GT(model.points().normal(i).dot(view.towards_camera), 0.29F);
    }
  }
  EXPECT_FLOAT_EQ(largest_share, 1);
  EXPECT_EQ(model.points().x_m.size(),
            model.views().back().first + model.views().back().points_n + std::size_t{16});
}

TEST_P(EveryModel, TheFirstPointsAreSpreadOverTheView) {
  const RegistrationModel& model = part_.registration;
  for (const View& view : model.views()) {
    // Every point has one of the first 16 within a third of the diameter, across the line of sight.
    for (std::uint32_t i = view.first; i < view.first + view.points_n; ++i) {
      float nearest_m = 1;
      for (std::uint32_t k = view.first; k < view.first + 16; ++k) {
        const Vector3f d = model.points().position_m(i) - model.points().position_m(k);
        nearest_m = std::min(nearest_m, d.cross(view.towards_camera).norm());
      }
      ASSERT_LT(nearest_m, part_.diameter_m / 3);
    }
  }
}

TEST_P(EveryModel, FindsTheNearestView) {
  const RegistrationModel& model = part_.registration;
  std::mt19937 random(5);
  std::normal_distribution<float> normal;
  for (int round = 0; round < 500; ++round) {
    const Vector3f direction =
        Vector3f(normal(random), normal(random), normal(random)).normalized();
    float best = -1;
    for (const View& view : model.views())
      best = std::max(best, view.towards_camera.dot(direction));
    // The lookup's cells are 4° wide.
    const float found = model.view_from(2.5F * direction).towards_camera.dot(direction);
    EXPECT_LT(std::acos(std::min(1.0F, found)), std::acos(std::min(1.0F, best)) + 0.09F);
  }
}

TEST_P(EveryModel, TemplatesShowTheirView) {
  const RegistrationModel& model = part_.registration;
  const PoseTemplates& templates = model.templates();
  const double cell_m = part_.diameter_m / 40;
  ASSERT_GT(templates.size(), templates.R_view_part.size()) << "several anchors a view";
  for (std::size_t t = 0; t < templates.size(); t += 7) {
    const Eigen::Matrix3f& R = templates.R_view_part[templates.views[t]];
    const View& view = model.view_from(-R.row(2).transpose());
    const Vector3f anchor = R * templates.anchors_m[t];
    for (int i = 0; i < PoseTemplates::kSamples; i += 5) {
      const int direction = i / PoseTemplates::kRings;
      const double angle_rad = 2 * M_PI * direction / PoseTemplates::kTurns;
      const double radius_m =
          double(PoseTemplates::kRadii[i % PoseTemplates::kRings]) * part_.diameter_m;
      const Eigen::Vector2f at =
          anchor.head<2>() +
          Eigen::Vector2d(std::cos(angle_rad), std::sin(angle_rad)).cast<float>() * float(radius_m);
      double nearest_m = 1, least_depth_m = 1, most_depth_m = -1;
      for (std::uint32_t k = view.first; k < view.first + view.points_n; ++k) {
        const Vector3f p = R * model.points().position_m(k);
        const double distance_m = double((p.head<2>() - at).norm());
        nearest_m = std::min(nearest_m, distance_m);
        if (distance_m > 3 * cell_m) continue;
        least_depth_m = std::min(least_depth_m, double(p.z() - anchor.z()));
        most_depth_m = std::max(most_depth_m, double(p.z() - anchor.z()));
      }
      const bool is_inside = (templates.inside[t] >> i & 1U) != 0;
      if (is_inside) {
        const double unit_m = double(PoseTemplates::kUnit) * part_.diameter_m;
        const double depth_m =
            templates.depths[t * PoseTemplates::kSamples + std::size_t(i)] * unit_m;
        EXPECT_GT(depth_m, least_depth_m - 0.6 * unit_m) << t << " " << i;
        EXPECT_LT(depth_m, most_depth_m + 0.6 * unit_m) << t << " " << i;
      } else {
        EXPECT_GT(nearest_m, 0.2 * cell_m) << t << " " << i;
      }
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Parts, EveryModel,
                         ::testing::Values("tee", "elbow", "straight_pipe", "hex_bolt", "l_bracket",
                                           "flanged_ring"));

TEST(RegistrationModel, SymmetriesSpareTemplates) {
  const Part block = graspd::testing::block_part("block", {0.08, 0.05, 0.03});
  Symmetries turns;
  for (int axis = 0; axis < 3; ++axis) {
    Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
    T.rotate(Eigen::AngleAxisd(M_PI, Eigen::Vector3d::Unit(axis)));
    turns.discrete.push_back(T);
  }
  const std::size_t all_n = block.registration.templates().size();
  const std::size_t spared_n = RegistrationModel(block.mesh, turns).templates().size();
  EXPECT_LT(spared_n, 0.45 * static_cast<double>(all_n));
  EXPECT_GE(spared_n, 0.2 * static_cast<double>(all_n)) << "a quarter is needed";
}

}  // namespace
}  // namespace graspd::parts
