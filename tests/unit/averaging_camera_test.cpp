#include "graspd/agent/averaging_camera.hpp"

#include <gmock/gmock.h>

#include "pick_cycle_fakes.hpp"

namespace graspd::agent {
namespace {

using fakes::FakeCamera;
using fakes::frame_of;
using ::testing::Each;

class AveragingCameraTest : public ::testing::Test {
 protected:
  fakes::FakeClock clock_;
  std::shared_ptr<FakeCamera> inner_ = std::make_shared<FakeCamera>(clock_);
  AveragingCamera camera_{inner_, 3};
};

TEST_F(AveragingCameraTest, GivesTheMeanOfTheNextFrames) {
  const std::vector<std::uint16_t> depths{750, 751, 755, 900, 900, 900};
  for (const std::uint16_t depth : depths) inner_->script.emplace_back(frame_of(depth));
  const auto first = camera_.next();
  ASSERT_TRUE(first && *first);
  EXPECT_THAT((*first)->depth, Each(7520));
  const auto second = camera_.next();
  ASSERT_TRUE(second && *second);
  EXPECT_THAT((*second)->depth, Each(9000));
  const auto end = camera_.next();
  ASSERT_TRUE(end);
  EXPECT_FALSE(*end);
}

TEST_F(AveragingCameraTest, TakesFewerWhereThereWillBeNoMore) {
  inner_->script.emplace_back(frame_of(750));
  inner_->script.emplace_back(frame_of(752));
  const auto frame = camera_.next();
  ASSERT_TRUE(frame && *frame);
  EXPECT_THAT((*frame)->depth, Each(7510));
}

TEST_F(AveragingCameraTest, PassesTheCamerasErrorOn) {
  inner_->script.emplace_back(frame_of(750));
  inner_->script.emplace_back(tl::unexpected(Error{Code::kUnavailable, "the camera is gone"}));
  const auto frame = camera_.next();
  ASSERT_FALSE(frame);
  EXPECT_EQ(frame.error().message, "the camera is gone");
}

}  // namespace
}  // namespace graspd::agent
