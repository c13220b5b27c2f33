#include "graspd/perception/bin_drift.hpp"

#include <gmock/gmock.h>

#include "block_scene.hpp"
#include "graspd/perception/planner.hpp"
#include "graspd/simulation/bin_mesh.hpp"
#include "graspd/simulation/kinect_v2.hpp"
#include "graspd/simulation/pile.hpp"
#include "graspd/simulation/scene.hpp"

// Bins of the simulated cell that lie elsewhere than the request says, and how full they are.
namespace graspd::perception {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;
using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

constexpr double kDegree_rad = M_PI / 180;
constexpr double kWall_m = 0.005;
const Vector3d kBin_m(0.30, 0.24, 0.12);
const Vector3d kBlock_m(0.06, 0.03, 0.02);

struct Placement {
  double x_m = 0, y_m = 0, turn_rad = 0;

  Eigen::Isometry3d T_expected_bin() const {
    return Eigen::Translation3d(x_m, y_m, 0) * Eigen::AngleAxisd(turn_rad, Vector3d::UnitZ());
  }
};

std::string name_of(const Placement& placement) {
  return fmt::format("{} mm, {} mm, {}°", placement.x_m * 1e3, placement.y_m * 1e3,
                     placement.turn_rad / kDegree_rad);
}

/// Of the real bins, in the frame of the expected one.
const std::vector<Placement> kPlacements{{0, 0, 0},
                                         {0.012, 0, 1.5 * kDegree_rad},
                                         {-0.004, 0.009, 0},
                                         {0.02, -0.015, -2 * kDegree_rad},
                                         {0, 0, 4 * kDegree_rad},
                                         {-0.035, 0.02, 1 * kDegree_rad}};

class BinDriftTest : public ::testing::Test {
 protected:
  BinDriftTest() { parameters_.preprocess.wall_bow_m = sensor_.wall_bow_m; }

  /// A bin with blocks in it, and where they lie in it.
  DepthFrame frame_of(const Placement& placement, int blocks_n, bool has_walls = true) {
    const Eigen::Isometry3d T_camera_bin = T_camera_expected() * placement.T_expected_bin();
    std::vector<simulation::SceneObject> scene;
    if (has_walls)
      scene.push_back({&bin_, T_camera_bin});
    else
      scene.push_back({&table_, T_camera_bin});
    pile_ = makers_.drop({blocks_n}, kBin_m, 7).value();
    for (const auto& part : pile_.parts) {
      scene.push_back({&block_.mesh, T_camera_bin * part.T_bin_part});
    }
    const simulation::Walls walls{T_camera_bin, kBin_m};
    return simulation::observe(scene, sensor_, 1, has_walls ? &walls : nullptr);
  }
  Eigen::Isometry3d T_camera_expected() const {
    return simulation::camera_over_bin(height_m_, tilt_rad_).inverse();
  }
  std::optional<BinDrift> drift_of(const DepthFrame& frame) const {
    return find_bin_drift(frame, T_camera_expected(), kBin_m, parameters_.preprocess);
  }
  void expect_found(const Placement& placement, int blocks_n, double tolerance_m,
                    double tolerance_y_m = 0) {
    SCOPED_TRACE(name_of(placement) + fmt::format(", {} blocks", blocks_n));
    const auto drift = drift_of(frame_of(placement, blocks_n));
    ASSERT_TRUE(drift);
    EXPECT_NEAR(drift->shift_m.x(), placement.x_m, tolerance_m);
    EXPECT_NEAR(drift->shift_m.y(), placement.y_m, std::max(tolerance_m, tolerance_y_m));
    EXPECT_NEAR(drift->turn_rad, placement.turn_rad, tolerance_m / 0.15);
  }
  PlanAnswer plan_of(const DepthFrame& frame) const {
    PlanRequest request;
    request.T_base_camera = T_camera_expected().inverse();
    request.bin = Bin{Eigen::Isometry3d::Identity(), kBin_m, kWall_m};
    request.parts = {{"block", 0}};
    return plan(frame, request, catalogue_, parameters_).value();
  }

  parts::Part block_ = testing::block_part("block", kBlock_m);
  parts::Catalogue catalogue_{{block_}};
  parts::Mesh bin_ = simulation::bin_mesh(kBin_m, kWall_m);
  parts::Mesh table_ = simulation::bin_mesh({0.001, 0.001, 0.001}, 0.001);
  simulation::PileMaker makers_{{block_.mesh}};
  simulation::Pile pile_;
  simulation::KinectV2Parameters sensor_;
  Parameters parameters_;
  double height_m_ = 0.75;
  double tilt_rad_ = 0;
};

TEST_F(BinDriftTest, AnEmptyBinIsFoundWhereItLies) {
  for (const Placement& placement : kPlacements) expect_found(placement, 0, 0.001);
}

// A tilted camera sees one of the walls across y alone, and how far multipath bends that is not
// known: where both are seen, it cancels out.
TEST_F(BinDriftTest, FromOtherCamerasToo) {
  for (const double height_m : {0.7, 0.9}) {
    for (const double tilt_rad : {-15 * kDegree_rad, 15 * kDegree_rad}) {
      height_m_ = height_m;
      tilt_rad_ = tilt_rad;
      for (const Placement& placement : kPlacements) expect_found(placement, 0, 0.002, 0.0035);
    }
  }
}

TEST_F(BinDriftTest, PartsAtTheWallsDoNotMoveIt) {
  for (const int blocks_n : {10, 30, 50}) {
    for (const Placement& placement : kPlacements) expect_found(placement, blocks_n, 0.0015);
  }
}

// A cell whose wall_bow_m nobody measured: all walls seem to be nearer to the middle.
TEST_F(BinDriftTest, WallsThatAreSeenBentDoNotMoveIt) {
  parameters_.preprocess.wall_bow_m = 0;
  for (const int blocks_n : {0, 30}) {
    for (const Placement& placement : kPlacements) expect_found(placement, blocks_n, 0.0015);
  }
}

TEST_F(BinDriftTest, WhereNoWallsAreNothingIsSaid) {
  for (const int blocks_n : {0, 10, 30}) {
    EXPECT_FALSE(drift_of(frame_of({}, blocks_n, false))) << blocks_n;
  }
}

TEST_F(BinDriftTest, AFewReadingsSayNothing) {
  DepthFrame frame = frame_of({}, 0);
  std::fill(frame.depth.begin(), frame.depth.end() - 1, std::uint16_t{0});
  EXPECT_FALSE(drift_of(frame));
}

TEST_F(BinDriftTest, ABinThatHasDriftedIsWarnedOf) {
  const PlanAnswer in_place = plan_of(frame_of({}, 10));
  EXPECT_THAT(in_place.warnings, IsEmpty());
  EXPECT_LT(in_place.bin_drift_m.value(), 0.006);
  const PlanAnswer answer = plan_of(frame_of({0.012, 0, 1.5 * kDegree_rad}, 10));
  EXPECT_NE(answer.outcome, Outcome::kBinNotFound);
  EXPECT_NEAR(answer.bin_drift_m.value(), 0.016, 0.004) << "at the corners 1.5° are 5 mm more";
  ASSERT_EQ(answer.warnings.size(), 1U);
  EXPECT_THAT(answer.warnings[0], AllOf(HasSubstr("the bin lies 1"), HasSubstr("mm along its x"),
                                        HasSubstr("and 1."), HasSubstr("T_base_bin")));
}

TEST_F(BinDriftTest, ABinTooFarOffIsNotFound) {
  const PlanAnswer answer = plan_of(frame_of({-0.035, 0.02, 0}, 10));
  EXPECT_EQ(answer.outcome, Outcome::kBinNotFound);
  EXPECT_THAT(answer.reason, HasSubstr("the bin lies -3"));
  EXPECT_NEAR(answer.bin_drift_m.value(), 0.040, 0.004);
  EXPECT_THAT(answer.grasps, IsEmpty());
  parameters_.preprocess.max_bin_drift_m = 0.05;
  EXPECT_NE(plan_of(frame_of({-0.035, 0.02, 0}, 10)).outcome, Outcome::kBinNotFound);
}

/// The mean height of what lies in the bin, of its height, looked at straight from above.
double true_fill_level(const simulation::Pile& pile) {
  constexpr double kCell_m = 0.002;
  const auto columns_n = static_cast<int>(kBin_m.x() / kCell_m);
  const auto rows_n = static_cast<int>(kBin_m.y() / kCell_m);
  double sum_m = 0;
  for (int row = 0; row < rows_n; ++row) {
    for (int column = 0; column < columns_n; ++column) {
      const Vector3d above_m((column + 0.5) * kCell_m - kBin_m.x() / 2,
                             (row + 0.5) * kCell_m - kBin_m.y() / 2, 1);
      double top_m = 0;
      for (const auto& part : pile.parts) {
        const testing::Block block{Eigen::Translation3d(-above_m) * part.T_bin_part, kBlock_m};
        if (const auto down_m = testing::hit(block, -Vector3d::UnitZ())) {
          top_m = std::max(top_m, above_m.z() - *down_m);
        }
      }
      sum_m += top_m;
    }
  }
  return sum_m / (columns_n * rows_n) / kBin_m.z();
}

TEST_F(BinDriftTest, TheFillLevelIsTheTrueOne) {
  double last = -1;
  for (const int blocks_n : {0, 10, 30, 60}) {
    const PlanAnswer answer = plan_of(frame_of({}, blocks_n));
    ASSERT_TRUE(answer.fill_level);
    EXPECT_NEAR(*answer.fill_level, true_fill_level(pile_), 0.05) << blocks_n;
    EXPECT_GT(*answer.fill_level, last);
    last = *answer.fill_level;
  }
}

}  // namespace
}  // namespace graspd::perception
