#include <gmock/gmock.h>

#include <numbers>
#include <regex>

#include "graspd/motion/inverse_kinematics.hpp"
#include "motion_support.hpp"
#include "temporary_folder.hpp"

namespace graspd::motion {
namespace {

using graspd::testing::anno;
using graspd::testing::anno_xml;
using graspd::testing::random_joints;
using graspd::testing::turn_between;
using std::numbers::pi;
using ::testing::HasSubstr;

std::unique_ptr<InverseKinematics> make(IkKind kind) {
  return make_inverse_kinematics(kind, anno()).value();
}

bool is_within_limits(const ArmModel& arm, const agent::Joints& q_rad) {
  for (int j = 0; j < q_rad.size(); ++j) {
    const JointLimits& of = arm.limits()[static_cast<std::size_t>(j)];
    if (q_rad[j] < of.min_rad - 1e-6 || q_rad[j] > of.max_rad + 1e-6) return false;
  }
  return true;
}

void expect_same_pose(const Eigen::Isometry3d& a, const Eigen::Isometry3d& b, double within) {
  EXPECT_LT((a.translation() - b.translation()).norm(), within);
  EXPECT_LT(turn_between(a, b), 10 * within);
}

/// One suite for every kind.
class AnyIk : public ::testing::TestWithParam<IkKind> {};

TEST_P(AnyIk, EverySolutionBringsTheFlangeThereWithinLimitsNearestFirst) {
  const ArmModel arm = anno();
  const auto ik = make(GetParam());
  std::mt19937 random(3);
  int found_n = 0;
  for (int i = 0; i < 500; ++i) {
    const agent::Joints near_rad = random_joints(random, arm);
    const Eigen::Isometry3d T = arm.T_base_flange(random_joints(random, arm));
    const auto all_rad = ik->solve(T, near_rad);
    if (!all_rad) continue;
    ++found_n;
    double last_rad = 0;
    for (const agent::Joints& q_rad : *all_rad) {
      expect_same_pose(arm.T_base_flange(q_rad), T, 1e-6);
      EXPECT_TRUE(is_within_limits(arm, q_rad)) << q_rad.transpose();
      const double turn_rad = (q_rad - near_rad).cwiseAbs().maxCoeff();
      EXPECT_GE(turn_rad, last_rad);
      last_rad = turn_rad;
    }
  }
  EXPECT_GE(found_n, 495);
}

TEST_P(AnyIk, FollowsASmallStepWithASmallTurn) {
  const ArmModel arm = anno();
  const auto ik = make(GetParam());
  std::mt19937 random(4);
  std::uniform_real_distribution<double> turn(-0.002, 0.002);
  for (int i = 0; i < 500; ++i) {
    const agent::Joints q_rad = 0.9 * random_joints(random, arm);
    const agent::Joints next_rad =
        q_rad + agent::Joints::NullaryExpr(6, [&] { return turn(random); });
    const auto followed_rad = ik->follow(arm.T_base_flange(next_rad), q_rad);
    ASSERT_TRUE(followed_rad) << followed_rad.error().message;
    expect_same_pose(arm.T_base_flange(*followed_rad), arm.T_base_flange(next_rad), 1e-6);
    EXPECT_LT((*followed_rad - q_rad).cwiseAbs().maxCoeff(), 0.3) << "a jump: see straight_path";
  }
}

TEST_P(AnyIk, OutOfReachIsSaid) {
  const auto ik = make(GetParam());
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  T.translation() = Eigen::Vector3d(0.9, 0.9, 0.2);
  const auto all_rad = ik->solve(T, agent::Joints::Zero(6));
  ASSERT_FALSE(all_rad);
  EXPECT_THAT(all_rad.error().message, HasSubstr("gets to"));
}

INSTANTIATE_TEST_SUITE_P(, AnyIk, ::testing::Values(IkKind::kAnno, IkKind::kKdl),
                         [](const auto& kind) { return std::string(name_of(kind.param)); });

TEST(AnnoIk, FindsTheJointsThatMadeThePose) {
  const ArmModel arm = anno();
  const auto ik = make(IkKind::kAnno);
  std::mt19937 random(5);
  for (int i = 0; i < 5000; ++i) {
    const agent::Joints q_rad = random_joints(random, arm);
    const auto all_rad = ik->solve(arm.T_base_flange(q_rad), q_rad);
    ASSERT_TRUE(all_rad) << all_rad.error().message;
    EXPECT_LT((all_rad->front() - q_rad).cwiseAbs().maxCoeff(), 1e-5) << q_rad.transpose();
    EXPECT_LE(all_rad->size(), 8U);
  }
}

TEST(AnnoIk, MissesNoBranchThatKdlFinds) {
  const ArmModel arm = anno();
  const auto ik = make(IkKind::kAnno);
  const auto kdl = make(IkKind::kKdl);
  std::mt19937 random(6);
  std::size_t branches_n = 0;
  for (int i = 0; i < 300; ++i) {
    const Eigen::Isometry3d T = arm.T_base_flange(random_joints(random, arm));
    const auto by_kdl_rad = kdl->solve(T, agent::Joints::Zero(6));
    if (!by_kdl_rad) continue;
    const auto all_rad = ik->solve(T, agent::Joints::Zero(6));
    ASSERT_TRUE(all_rad);
    for (const agent::Joints& q_rad : *by_kdl_rad) {
      ++branches_n;
      double nearest_rad = pi;
      for (const agent::Joints& own_rad : *all_rad) {
        nearest_rad = std::min(nearest_rad, (own_rad - q_rad).cwiseAbs().maxCoeff());
      }
      EXPECT_LT(nearest_rad, 1e-3) << q_rad.transpose();
    }
  }
  EXPECT_GT(branches_n, 600U);
}

TEST(AnnoIk, EightWaysWhereNoLimitForbidsThem) {
  // In front of the arm, tilted: all of shoulder, elbow and wrist can go both ways if the joints
  // turn far enough.
  std::string xml = anno_xml();
  xml = std::regex_replace(xml, std::regex("lower=\"[^\"]*\" upper=\"[^\"]*\""),
                           "lower=\"-6.3\" upper=\"6.3\"");
  const graspd::testing::TemporaryFolder folder;
  const ArmModel arm = ArmModel::load(folder.write("free.urdf", xml)).value();
  const auto ik = make_inverse_kinematics(IkKind::kAnno, arm).value();
  std::mt19937 random(7);
  for (int i = 0; i < 200; ++i) {
    const Eigen::Isometry3d T = arm.T_base_flange(random_joints(random, arm));
    const auto all_rad = ik->solve(T, agent::Joints::Zero(6));
    ASSERT_TRUE(all_rad);
    EXPECT_EQ(all_rad->size(), 8U);
  }
}

TEST(AnnoIk, DownwardIsAFlatWrist) {
  const ArmModel arm = anno();
  const auto ik = make(IkKind::kAnno);
  // z of the flange points into the arm: up.
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  T.translation() = Eigen::Vector3d(0.3, 0.05, 0.2);
  const auto all_rad = ik->solve(T, agent::Joints::Zero(6));
  ASSERT_TRUE(all_rad);
  const agent::Joints& q_rad = all_rad->front();
  EXPECT_NEAR(q_rad[3], 0, 1e-9);
  EXPECT_NEAR(q_rad[4], -(q_rad[1] + q_rad[2]), 1e-9);
}

TEST(AnnoIk, KeepsJoint4WhereItTurnsAboutTheSameAxisAsJoint6) {
  const ArmModel arm = anno();
  const auto ik = make(IkKind::kAnno);
  agent::Joints q_rad(6);
  q_rad << 0.3, -0.4, 0.5, 0.7, pi / 2, -0.2;
  const auto all_rad = ik->solve(arm.T_base_flange(q_rad), q_rad);
  ASSERT_TRUE(all_rad);
  EXPECT_LT((all_rad->front() - q_rad).cwiseAbs().maxCoeff(), 1e-6);
}

TEST(AnnoIk, AnotherArmIsRefused) {
  std::string xml = anno_xml();
  const std::string wrist = "xyz=\"0 -0.042 0\"";
  xml.replace(xml.find(wrist), wrist.size(), "xyz=\"0.01 -0.042 0\"");
  const graspd::testing::TemporaryFolder folder;
  const ArmModel arm = ArmModel::load(folder.write("offset.urdf", xml)).value();
  const auto ik = make_inverse_kinematics(IkKind::kAnno, arm);
  ASSERT_FALSE(ik);
  EXPECT_THAT(ik.error().message, HasSubstr("not built like an Anno"));
  EXPECT_THAT(ik.error().message, HasSubstr("ik: kdl"));
}

}  // namespace
}  // namespace graspd::motion
