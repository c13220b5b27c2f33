#include <gmock/gmock.h>

#include "gripper_rigs.hpp"

/// What every gripper must do, run on each of them with a part between its fingers.
namespace graspd::agent {
namespace {

class GripperContract : public ::testing::TestWithParam<testing::NamedGripperRig> {
 protected:
  Gripper& gripper() { return rig_->gripper(); }
  bool holds() {
    const auto held = gripper().holds_something();
    EXPECT_TRUE(held) << held.error().message;
    return held.value_or(false);
  }

 private:
  std::unique_ptr<testing::GripperRig> rig_ = GetParam().make();
};

TEST_P(GripperContract, HoldsWhatItClosesOnUntilItOpens) {
  ASSERT_TRUE(gripper().open(0.04));
  EXPECT_FALSE(holds());
  ASSERT_TRUE(gripper().close());
  EXPECT_TRUE(holds());
  EXPECT_TRUE(holds());
  ASSERT_TRUE(gripper().open(0.04));
  EXPECT_FALSE(holds());
}

TEST_P(GripperContract, MayBeToldTwice) {
  ASSERT_TRUE(gripper().open(0.02));
  ASSERT_TRUE(gripper().open(0.05));
  ASSERT_TRUE(gripper().close());
  ASSERT_TRUE(gripper().close());
  EXPECT_TRUE(holds());
}

INSTANTIATE_TEST_SUITE_P(Grippers, GripperContract, ::testing::ValuesIn(testing::kGripperRigs),
                         [](const auto& tested) { return tested.param.name; });

}  // namespace
}  // namespace graspd::agent
