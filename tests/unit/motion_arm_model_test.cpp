#include <gmock/gmock.h>
#include <mrpt/kinematics/CKinematicChain.h>

#include <numbers>
#include <regex>

#include "graspd/motion/arm_model.hpp"
#include "motion_support.hpp"
#include "temporary_folder.hpp"

namespace graspd::motion {
namespace {

using graspd::testing::anno;
using graspd::testing::anno_xml;
using graspd::testing::joints;
using graspd::testing::random_joints;
using graspd::testing::turn_between;
using std::numbers::pi;
using ::testing::HasSubstr;

/// The arm by its Denavit-Hartenberg numbers, by MRPT. The last frame is tool0 turned by 180° about
/// x.
Eigen::Isometry3d T_base_flange_by_mrpt(const agent::Joints& q_rad) {
  mrpt::kinematics::CKinematicChain chain;
  chain.addLink(q_rad[0], 0.262, 0, pi / 2, false);
  chain.addLink(q_rad[1] + pi / 2, 0, 0.225, 0, false);
  chain.addLink(q_rad[2], 0, 0, pi / 2, false);
  chain.addLink(q_rad[3], 0.22885535, 0, -pi / 2, false);
  chain.addLink(q_rad[4] - pi / 2, 0, 0, pi / 2, false);
  chain.addLink(q_rad[5], 0.055, 0, 0, false);
  std::vector<mrpt::poses::CPose3D> poses;
  chain.recomputeAllPoses(poses);
  Eigen::Isometry3d T_base_dh;
  T_base_dh.matrix() =
      poses.back().getHomogeneousMatrixVal<mrpt::math::CMatrixDouble44>().asEigen();
  return T_base_dh * Eigen::AngleAxisd(pi, Eigen::Vector3d::UnitX());
}

TEST(ArmModel, AnnoStandsWhereItsDescriptionSays) {
  const ArmModel arm = anno();
  ASSERT_EQ(arm.joints_n(), 6);
  const Eigen::Isometry3d T_zero = arm.T_base_flange(agent::Joints::Zero(6));
  EXPECT_TRUE(T_zero.translation().isApprox(Eigen::Vector3d(0.22885535, 0, 0.4320), 1e-6));
  const Eigen::Isometry3d T_down =
      arm.T_base_flange(joints({0.927, -0.687, -0.396, 0, 1.083, 0.927}));
  EXPECT_LT((T_down.translation() - Eigen::Vector3d(0.1500, 0.1999, 0.1788)).norm(), 1e-4);
  // tool0's z points into the arm: up, where the flange looks down.
  EXPECT_LT((T_down.linear().col(2) - Eigen::Vector3d::UnitZ()).norm(), 1e-9);
}

TEST(ArmModel, AgreesWithMrptsChainOfDenavitHartenbergNumbers) {
  const ArmModel arm = anno();
  std::mt19937 random(1);
  for (int i = 0; i < 1000; ++i) {
    const agent::Joints q_rad = random_joints(random, arm);
    const Eigen::Isometry3d T = arm.T_base_flange(q_rad);
    const Eigen::Isometry3d T_mrpt = T_base_flange_by_mrpt(q_rad);
    ASSERT_LT((T.translation() - T_mrpt.translation()).norm(), 1e-9);
    ASSERT_LT(turn_between(T, T_mrpt), 1e-7);
  }
}

TEST(ArmModel, AJointMovesTheLinksAfterItAndNoOther) {
  const ArmModel arm = anno();
  std::mt19937 random(2);
  const agent::Joints q_rad = random_joints(random, arm);
  const auto before = arm.link_poses(q_rad);
  for (int j = 0; j < arm.joints_n(); ++j) {
    agent::Joints turned = q_rad;
    turned[j] += 0.3;
    const auto after = arm.link_poses(turned);
    for (std::size_t i = 0; i < after.size(); ++i) {
      EXPECT_EQ(turn_between(before[i], after[i]) > 0.29, arm.links()[i].joints_before_n > j)
          << arm.links()[i].name << ", " << arm.limits()[static_cast<std::size_t>(j)].name;
    }
  }
}

TEST(ArmModel, LimitsComeFromTheFile) {
  const ArmModel arm = anno();
  const JointLimits& joint_3 = arm.limits()[2];
  EXPECT_EQ(joint_3.name, "joint_3");
  EXPECT_EQ(joint_3.min_rad, -0.6981);
  EXPECT_EQ(joint_3.max_rad, 3.8397);
  EXPECT_EQ(joint_3.max_velocity_rad_s, 1.0);
  EXPECT_EQ(joint_3.max_acceleration_rad_s2, 2.0);
}

/// The Anno's file with one thing changed, and what must be said of it.
struct Wrong {
  std::string what, from, to, said;

  friend void PrintTo(const Wrong& wrong, std::ostream* out) { *out << wrong.what; }
};

class WrongUrdf : public ::testing::TestWithParam<Wrong> {};

TEST_P(WrongUrdf, IsRefusedWithASentence) {
  const std::string xml = anno_xml();
  const std::string changed = std::regex_replace(xml, std::regex(GetParam().from), GetParam().to,
                                                 std::regex_constants::format_first_only);
  ASSERT_NE(changed, xml);
  const graspd::testing::TemporaryFolder folder;
  const auto path = folder.write("arm.urdf", changed);
  const auto arm = ArmModel::load(path);
  ASSERT_FALSE(arm);
  EXPECT_EQ(arm.error().code, Code::kInvalidArgument);
  EXPECT_THAT(arm.error().message, HasSubstr(path.string()));
  EXPECT_THAT(arm.error().message, HasSubstr(GetParam().said));
}

INSTANTIATE_TEST_SUITE_P(
    , WrongUrdf,
    ::testing::Values(
        Wrong{"NoXml", "<robot", "<<robot", "not a URDF"},
        Wrong{"NoSuchParent", "parent link=\"link_2\"", "parent link=\"link_9\"", "link_9"},
        Wrong{"NoLimits", "<limit[^>]*>", "", "joint_1"},
        Wrong{"LimitsTheWrongWayRound", "lower=\"-3.1416\"", "lower=\"4\"",
              "joint 'joint_1' has lower limit 4 and upper limit 3.1416"},
        Wrong{"NoVelocity", "velocity=\"1.0\"", "velocity=\"0\"", "joint 'joint_1' has velocity 0"},
        Wrong{"NegativeAcceleration", "acceleration=\"2.0\"", "acceleration=\"-2\"",
              "acceleration -2: both must be above 0"},
        Wrong{"Slides", "joint_2\" type=\"revolute", "joint_2\" type=\"prismatic",
              "joint 'joint_2' does not turn"},
        Wrong{"Mesh", "<cylinder[^>]*>", "<mesh filename=\"a.stl\"/>",
              "link 'base_link' has a mesh"},
        Wrong{"NoSize", "<box size=\"0.07", "<box size=\"-0.07", "link 'link_2'"},
        Wrong{"NoSuchChild", "child link=\"tool0\"", "child link=\"hand\"", "hand"},
        Wrong{"TurningJointOffTheChain", "parent link=\"link_6\"", "parent link=\"base_link\"",
              "is not between base and flange"}),
    [](const auto& wrong) { return wrong.param.what; });

TEST(WrongUrdfFile, ThatIsNotThereIsNamed) {
  const auto arm = ArmModel::load("/nowhere/arm.urdf");
  ASSERT_FALSE(arm);
  EXPECT_THAT(arm.error().message, HasSubstr("/nowhere/arm.urdf: can't be read"));
}

}  // namespace
}  // namespace graspd::motion
