#include <gmock/gmock.h>

#include <numbers>

#include "graspd/motion/straight_path.hpp"
#include "motion_support.hpp"

namespace graspd::motion {
namespace {

using graspd::testing::anno;
using graspd::testing::random_joints;
using graspd::testing::turn_between;
using ::testing::HasSubstr;

constexpr double kPeriod_s = 0.02;
constexpr double kTipSpeed_m_s = 0.25;

/// From rest to rest between the path's ends, within all limits: the mean velocities between points
/// can't exceed the limit, and neither can their differences that of acceleration.
void expect_within_limits(const agent::JointTrajectory& trajectory, const ArmModel& arm) {
  ASSERT_GE(trajectory.size(), 2U);
  EXPECT_EQ(trajectory.front().t_s, 0);
  const double dt_s = trajectory[1].t_s;
  ASSERT_LE(dt_s, kPeriod_s + 1e-12);
  Eigen::VectorXd last = Eigen::VectorXd::Zero(arm.joints_n());
  for (std::size_t i = 1; i <= trajectory.size(); ++i) {
    Eigen::VectorXd velocity = Eigen::VectorXd::Zero(arm.joints_n());  // at rest after the end
    if (i < trajectory.size()) {
      ASSERT_NEAR(trajectory[i].t_s - trajectory[i - 1].t_s, dt_s, 1e-9);
      velocity = (trajectory[i].q_rad - trajectory[i - 1].q_rad) / dt_s;
    }
    for (int j = 0; j < arm.joints_n(); ++j) {
      const JointLimits& of = arm.limits()[static_cast<std::size_t>(j)];
      ASSERT_LE(std::abs(velocity[j]), of.max_velocity_rad_s + 1e-6);
      ASSERT_LE(std::abs(velocity[j] - last[j]) / dt_s, of.max_acceleration_rad_s2 + 1e-6)
          << of.name << " at " << trajectory[i - 1].t_s << " s";
    }
    last = velocity;
  }
}

TEST(Trajectory, OfAJointMoveKeepsToTheLimitsAndIsAsFastAsTheyAllow) {
  const ArmModel arm = anno();
  std::mt19937 random(8);
  for (int i = 0; i < 200; ++i) {
    const agent::Joints from_rad = random_joints(random, arm);
    const agent::Joints to_rad = random_joints(random, arm);
    const auto trajectory = time_parameterise(joint_line(from_rad, to_rad, 0.05), arm.limits(),
                                              kTipSpeed_m_s, kPeriod_s);
    EXPECT_EQ(trajectory.front().q_rad, from_rad);
    EXPECT_TRUE(trajectory.back().q_rad.isApprox(to_rad, 1e-12));
    expect_within_limits(trajectory, arm);
    // The joint that has furthest to go speeds up, keeps its speed and slows down.
    const double way_rad = (to_rad - from_rad).cwiseAbs().maxCoeff();
    const double shortest_s = way_rad >= 0.5 ? way_rad + 0.5 : 2 * std::sqrt(way_rad / 2);
    EXPECT_GE(trajectory.back().t_s, shortest_s - 1e-9);
    EXPECT_LE(trajectory.back().t_s, 1.1 * shortest_s);
  }
}

TEST(Trajectory, RoundsTheCornersOfAPathWithoutStopping) {
  const ArmModel arm = anno();
  std::mt19937 random(9);
  for (int i = 0; i < 50; ++i) {
    JointPath path;
    agent::Joints at_rad = random_joints(random, arm);
    for (int k = 0; k < 4; ++k) {
      const agent::Joints next_rad = random_joints(random, arm);
      path.append(joint_line(at_rad, next_rad, 0.05));
      at_rad = next_rad;
    }
    const auto trajectory = time_parameterise(path, arm.limits(), kTipSpeed_m_s, kPeriod_s);
    expect_within_limits(trajectory, arm);
    for (const agent::JointPoint& point : trajectory) {
      double nearest_rad = 10;
      for (const agent::Joints& q_rad : path.q_rad) {
        nearest_rad = std::min(nearest_rad, (q_rad - point.q_rad).cwiseAbs().maxCoeff());
      }
      ASSERT_LE(nearest_rad, 0.05 / 2 + 0.1 / 8);
    }
    for (std::size_t k = 2; k + 1 < trajectory.size(); ++k) {
      EXPECT_GT((trajectory[k].q_rad - trajectory[k - 1].q_rad).cwiseAbs().maxCoeff(), 1e-5);
    }
  }
}

TEST(Trajectory, OfNoWayStaysThere) {
  const ArmModel arm = anno();
  const agent::Joints q_rad = agent::Joints::Zero(6);
  const auto trajectory =
      time_parameterise(joint_line(q_rad, q_rad, 0.05), arm.limits(), kTipSpeed_m_s, kPeriod_s);
  ASSERT_EQ(trajectory.size(), 2U);
  EXPECT_EQ(trajectory.back().q_rad, q_rad);
  EXPECT_GT(trajectory.back().t_s, 0);
}

class Straight : public ::testing::Test {
 protected:
  Straight() {
    // Fingers 0.13 m before the flange, which looks against its z.
    T_flange_grasp = Eigen::Translation3d(0, 0, -0.13) *
                     Eigen::AngleAxisd(std::numbers::pi, Eigen::Vector3d::UnitX());
  }

  Result<JointPath> plan(const Eigen::Isometry3d& T_start, const Eigen::Isometry3d& T_end) {
    const Eigen::Isometry3d T_grasp_flange = T_flange_grasp.inverse();
    const auto starts_rad = ik->solve(T_start * T_grasp_flange, agent::Joints::Zero(6));
    if (!starts_rad) return tl::unexpected(starts_rad.error());
    return straight_path(*ik, {T_start, T_end, T_grasp_flange}, starts_rad->front(), arm.limits(),
                         0.005);
  }

  Eigen::Isometry3d T_base_grasp(const agent::Joints& q_rad) const {
    return arm.T_base_flange(q_rad) * T_flange_grasp;
  }

  /// Looking down, tilted by up to 0.3 rad.
  static Eigen::Isometry3d over_the_bin(std::mt19937& random, double z_m) {
    std::uniform_real_distribution<double> side(-0.1, 0.1);
    std::uniform_real_distribution<double> tilt(-0.3, 0.3);
    std::uniform_real_distribution<double> yaw(-3, 3);
    Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
    T.translate(Eigen::Vector3d(0.31 + side(random), side(random), z_m));
    T.rotate(Eigen::AngleAxisd(yaw(random), Eigen::Vector3d::UnitZ()));
    T.rotate(Eigen::AngleAxisd(std::numbers::pi + tilt(random), Eigen::Vector3d::UnitX()));
    T.rotate(Eigen::AngleAxisd(tilt(random), Eigen::Vector3d::UnitY()));
    return T;
  }

  ArmModel arm = anno();
  std::unique_ptr<InverseKinematics> ik = make_inverse_kinematics(IkKind::kAnno, arm).value();
  Eigen::Isometry3d T_flange_grasp;
};

TEST_F(Straight, FollowedLinearlyTheTipStaysOnTheLineAndBelowItsSpeed) {
  std::mt19937 random(10);
  int planned_n = 0;
  for (int i = 0; i < 200; ++i) {
    const Eigen::Isometry3d T_end = over_the_bin(random, 0.05);
    const Eigen::Isometry3d T_start = T_end * Eigen::Translation3d(0, 0, -0.08);
    const auto path = plan(T_start, T_end);
    if (!path) continue;
    ++planned_n;
    const auto trajectory = time_parameterise(*path, arm.limits(), kTipSpeed_m_s, kPeriod_s);
    expect_within_limits(trajectory, arm);
    const Eigen::Vector3d along = T_end.linear().col(2);
    double last_m = 0;
    for (std::size_t k = 1; k < trajectory.size(); ++k) {
      for (const double share : {0.5, 1.0}) {
        const agent::Joints q_rad =
            (1 - share) * trajectory[k - 1].q_rad + share * trajectory[k].q_rad;
        const Eigen::Isometry3d T = T_base_grasp(q_rad);
        const Eigen::Vector3d way_m = T.translation() - T_start.translation();
        const double on_line_m = way_m.dot(along);
        ASSERT_LT((way_m - on_line_m * along).norm(), 0.0005);
        ASSERT_LT(turn_between(T, T_end), 0.003);
        if (share < 1) continue;
        const double dt_s = trajectory[k].t_s - trajectory[k - 1].t_s;
        ASSERT_LE(std::abs(on_line_m - last_m) / dt_s, 1.001 * kTipSpeed_m_s);
        last_m = on_line_m;
      }
    }
    EXPECT_NEAR(last_m, 0.08, 1e-6);
  }
  EXPECT_GT(planned_n, 100);
}

TEST_F(Straight, SaysWhatIsInTheWayAndWhere) {
  Eigen::Isometry3d T_start = Eigen::Isometry3d::Identity();
  T_start.translate(Eigen::Vector3d(0.35, 0, 0.1));
  T_start.rotate(Eigen::AngleAxisd(std::numbers::pi, Eigen::Vector3d::UnitX()));
  const Eigen::Isometry3d T_end = Eigen::Translation3d(0.3, 0, 0) * T_start;
  const auto path = plan(T_start, T_end);
  ASSERT_FALSE(path);
  EXPECT_THAT(path.error().message, HasSubstr("from the shoulder"));
  EXPECT_THAT(path.error().message, ::testing::ContainsRegex("after [0-9]+ mm"));
}

TEST_F(Straight, DoesNotJumpFromOneWayToAnother) {
  // Through the axis of joint 1, where it would have to turn by half a turn at once.
  Eigen::Isometry3d T_start = Eigen::Isometry3d::Identity();
  T_start.translate(Eigen::Vector3d(0.2, 0.001, 0.5));
  const Eigen::Isometry3d T_end = Eigen::Translation3d(-0.4, 0, 0) * T_start;
  const auto path = plan(T_start, T_end);
  ASSERT_FALSE(path);
  EXPECT_THAT(path.error().message, HasSubstr("joint_"));
}

}  // namespace
}  // namespace graspd::motion
