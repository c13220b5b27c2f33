#include "graspd/calibration/hand_eye.hpp"

#include <gmock/gmock.h>

#include <random>

#include "board_scene.hpp"
#include "graspd/types/camera_model.hpp"
#include "robot_world.hpp"

/// An overhead camera, a board on the flange, and what is seen of it: poses and images are
/// simulated, the true pose of the camera is known.
namespace graspd::calibration {
namespace {

using Eigen::AngleAxisd;
using Eigen::Isometry3d;
using Eigen::Vector3d;
using ::testing::AllOf;
using ::testing::HasSubstr;
using testing::kKinect;

const Board kCellBoard{7, 5, 0.04, 0.03, "DICT_4X4_50", 0.01};

double angle_between(const Isometry3d& a, const Isometry3d& b) {
  return AngleAxisd(a.linear().transpose() * b.linear()).angle();
}

class Cell {
 public:
  Cell() {
    T_base_camera.translation() << 0.31, 0.02, 0.95;
    T_base_camera.linear() =
        (AngleAxisd(M_PI, Vector3d::UnitX()) * AngleAxisd(0.05, Vector3d(1, 2, 3).normalized()))
            .toRotationMatrix();
    T_flange_board.translation() << -0.13, 0.09, 0.03;
    T_flange_board.linear() =
        (AngleAxisd(M_PI, Vector3d::UnitX()) * AngleAxisd(0.2, Vector3d(1, -1, 2).normalized()))
            .toRotationMatrix();
  }

  /// Views tilted by up to ±`tilt_rad`, of which the arm says its pose with this noise.
  std::vector<FlangeView> look(int views_n, const Vector3d& tilt_rad, double noise_m,
                               double noise_rad, std::uint64_t seed) const {
    std::mt19937_64 random(seed);
    std::uniform_real_distribution<double> uniform(-1, 1);
    std::normal_distribution<double> gaussian;
    const auto vector_of = [](auto&& number) {
      const double x = number();
      const double y = number();
      return Vector3d(x, y, number());
    };
    const auto anywhere = [&] { return uniform(random); };
    const auto noise = [&] { return gaussian(random); };
    std::vector<FlangeView> views;
    for (int i = 0; i < views_n; ++i) {
      const Vector3d place = vector_of(anywhere);
      const Vector3d turn_rad = vector_of(anywhere).cwiseProduct(tilt_rad);
      const Isometry3d T_camera_board = testing::facing(
          kCellBoard, {0.08 * place.x(), 0.06 * place.y()}, 0.65 + 0.1 * place.z(), turn_rad);
      FlangeView view{fmt::format("{:02}.png", i),
                      T_base_camera * T_camera_board * T_flange_board.inverse(),
                      corners(T_camera_board, noise)};
      view.T_base_flange.translation() += noise_m * vector_of(noise);
      const Vector3d shake_rad = noise_rad * vector_of(noise);
      if (shake_rad.norm() > 0) {
        view.T_base_flange.rotate(AngleAxisd(shake_rad.norm(), shake_rad.normalized()));
      }
      views.push_back(view);
    }
    return views;
  }

  /// As `find_board` finds them in a simulated image (board_test), without the image.
  static BoardView corners(const Isometry3d& T_camera_board, const auto& noise) {
    BoardView view;
    for (int row = 1; row < kCellBoard.rows_n; ++row) {
      for (int column = 1; column < kCellBoard.columns_n; ++column) {
        const Vector3d p_board_m(column * kCellBoard.square_m, row * kCellBoard.square_m, 0);
        const double du_px = 0.12 * noise();
        const double dv_px = 0.12 * noise();
        view.p_board_m.push_back(p_board_m);
        view.p_px.push_back(project(kKinect, T_camera_board * p_board_m) +
                            Eigen::Vector2d(du_px, dv_px));
      }
    }
    find_pose(view, kKinect);
    return view;
  }

  Isometry3d T_base_camera = Isometry3d::Identity();
  Isometry3d T_flange_board = Isometry3d::Identity();
};

const Vector3d kTilts{0.6, 0.6, 0.8};

/// How far off the bin, 0.7 m below the camera, a wrong camera pose puts things.
double off_at_bin_m(const Isometry3d& found, const Isometry3d& truth) {
  const Vector3d p_camera(0.05, 0.05, 0.7);
  return (found * p_camera - truth * p_camera).norm();
}

std::string calibration_fault(const std::vector<FlangeView>& views,
                              const Board& board = kCellBoard) {
  const auto found = calibrate_hand_eye(views, board, kKinect);
  EXPECT_FALSE(found);
  return found ? "" : found.error().message;
}

TEST(HandEye, AnExactArmGivesTheCameraToUnderAMillimetre) {
  const Cell cell;
  const auto found = calibrate_hand_eye(cell.look(15, kTilts, 0, 0, 1), kCellBoard, kKinect);
  ASSERT_TRUE(found) << found.error().message;
  EXPECT_LT(off_at_bin_m(found->T_base_camera, cell.T_base_camera), 0.001);
  EXPECT_LT(angle_between(found->T_base_camera, cell.T_base_camera), 0.002);
  EXPECT_LT((found->T_flange_board.translation() - cell.T_flange_board.translation()).norm(),
            0.001);
  EXPECT_LT(found->reprojection_rms_px, 0.3);
  EXPECT_NEAR(found->square_m, kCellBoard.square_m, 0.0002);
}

/// Mean over some cells of what each way to solve is off by at the bin.
struct Means {
  double shah_m = 0;
  double plain_m = 0;  ///< least squares over the corners, whatever the arm is off by
  double weighed_m = 0;
};
Means means_over_cells(double noise_m, double noise_rad) {
  constexpr int kCells = 30;
  const Cell cell;
  const auto off_m = [&](const RobotWorld& found) {
    return off_at_bin_m(found.T_base_camera, cell.T_base_camera) / kCells;
  };
  HandEyeOptions exact_arm;
  exact_arm.flange_sigma_m = exact_arm.flange_sigma_rad = 1e-9;
  Means means;
  for (int i = 0; i < kCells; ++i) {
    const auto views = cell.look(20, kTilts, noise_m, noise_rad, 1000 + i);
    ViewRefs refs;
    for (const FlangeView& view : views) refs.push_back(&view);
    const RobotWorld shah = solve_shah(refs);
    means.shah_m += off_m(shah);
    means.plain_m += off_m(refine(refs, kKinect, exact_arm, shah, false));
    means.weighed_m += off_m(refine(refs, kKinect, {}, shah, false));
  }
  return means;
}

TEST(HandEye, RefiningIsBetterThanTheClosedFormWhereTheArmIsExact) {
  const Means means = means_over_cells(0, 0);
  RecordProperty("shah_mm", std::to_string(means.shah_m * 1e3));
  RecordProperty("weighed_mm", std::to_string(means.weighed_m * 1e3));
  EXPECT_LT(means.weighed_m, 0.7 * means.shah_m);
  EXPECT_LT(means.weighed_m, 0.0003);
}

TEST(HandEye, WeighingKeepsAnArmThatIsOffFromSpoilingIt) {
  const Means means = means_over_cells(0.0012, 0.005);
  RecordProperty("shah_mm", std::to_string(means.shah_m * 1e3));
  RecordProperty("plain_mm", std::to_string(means.plain_m * 1e3));
  RecordProperty("weighed_mm", std::to_string(means.weighed_m * 1e3));
  EXPECT_LT(means.weighed_m, 0.8 * means.plain_m);
  EXPECT_LT(means.weighed_m, 1.1 * means.shah_m);
  EXPECT_LT(means.weighed_m, 0.0015);
}

TEST(HandEye, HeldOutErrorsTellWhatTheArmIsOffBy) {
  const Cell cell;
  const auto exact = calibrate_hand_eye(cell.look(20, kTilts, 0, 0, 2), kCellBoard, kKinect);
  const auto noisy =
      calibrate_hand_eye(cell.look(20, kTilts, 0.0012, 0.005, 2), kCellBoard, kKinect);
  ASSERT_TRUE(exact && noisy);
  EXPECT_EQ(noisy->held_out.size(), 20U);
  EXPECT_GE(noisy->held_out.front().position_m, noisy->held_out.back().position_m);
  // Three axes of 1.2 mm, and 0.3° about the flange on a lever of 0.16 m, beside the camera's own.
  EXPECT_GT(noisy->position_rms_m, 0.0015);
  EXPECT_LT(noisy->position_rms_m, 0.004);
  EXPECT_LT(exact->position_rms_m, 0.0015);
  EXPECT_LT(exact->rotation_rms_rad, noisy->rotation_rms_rad);
  // The camera itself is better known than any one view.
  EXPECT_LT(off_at_bin_m(noisy->T_base_camera, cell.T_base_camera), 0.002);
}

TEST(HandEye, OneWrongPoseSticksOut) {
  auto views = Cell().look(15, kTilts, 0.0003, 0.001, 3);
  views[7].T_base_flange.pretranslate(Vector3d(0.02, 0, 0));
  const auto found = calibrate_hand_eye(views, kCellBoard, kKinect);
  ASSERT_TRUE(found) << found.error().message;
  EXPECT_EQ(found->held_out.front().name, "07.png");
  EXPECT_GT(found->held_out.front().position_m, 3 * found->held_out[1].position_m);
}

TEST(HandEye, FewViewsAreRefused) {
  EXPECT_THAT(calibration_fault(Cell().look(7, kTilts, 0, 0, 4)),
              AllOf(HasSubstr("7 views"), HasSubstr("at least 8")));
  EXPECT_THAT(calibration_fault({}), HasSubstr("0 views"));
}

TEST(HandEye, ParallelViewsAreRefused) {
  EXPECT_THAT(calibration_fault(Cell().look(10, {0, 0, 0}, 0, 0.001, 5)),
              HasSubstr("one axis only"));
  EXPECT_THAT(calibration_fault(Cell().look(10, {0, 0, 0.8}, 0, 0.001, 5)),
              HasSubstr("one axis only"));
}

TEST(HandEye, ABoardOfAnotherSizeIsSaidWithTheSizeThatFits) {
  auto views = Cell().look(12, kTilts, 0.0005, 0.002, 6);
  Board said = kCellBoard;
  said.square_m = 0.042;  // and what follows from it, as `find_board` would have it
  for (FlangeView& view : views) {
    for (Vector3d& p : view.board.p_board_m) p *= 1.05;
    view.board.T_camera_board.translation() *= 1.05;
  }
  EXPECT_THAT(
      calibration_fault(views, said),
      AllOf(::testing::ContainsRegex("squares of (39.[789]|40.[012])"), HasSubstr("42.00 mm")));
}

}  // namespace
}  // namespace graspd::calibration
