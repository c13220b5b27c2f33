#include "graspd/types/mean_frame.hpp"

#include <gmock/gmock.h>

namespace graspd {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

/// One row of readings in millimetres.
DepthFrame row(std::vector<std::uint16_t> depth) {
  DepthFrame frame;
  frame.camera = {static_cast<int>(depth.size()), 1, 365, 365, 1, 0, {}};
  frame.depth = std::move(depth);
  return frame;
}

TEST(MeanFrame, OfOneFrameIsThatFrame) {
  const DepthFrame frame = row({0, 750, 800});
  const auto mean = mean_frame({&frame, 1});
  ASSERT_TRUE(mean);
  EXPECT_EQ(mean->depth, frame.depth);
  EXPECT_EQ(mean->depth_scale_m, frame.depth_scale_m);
}

TEST(MeanFrame, IsFinerThanItsFrames) {
  const std::vector frames{row({750, 800}), row({751, 800}), row({751, 803}), row({751, 801})};
  const auto mean = mean_frame(frames);
  ASSERT_TRUE(mean);
  EXPECT_DOUBLE_EQ(mean->depth_scale_m, 0.0001);
  EXPECT_THAT(mean->depth, ElementsAre(7508, 8010));  // 750.75, rounded
}

TEST(MeanFrame, HasAReadingWhereMoreThanHalfOfTheFramesHave) {
  const std::vector frames{row({750, 0, 0}), row({0, 0, 0}), row({752, 750, 0}), row({751, 0, 0})};
  const auto mean = mean_frame(frames);
  ASSERT_TRUE(mean);
  EXPECT_THAT(mean->depth, ElementsAre(7510, 0, 0));
}

TEST(MeanFrame, DoesNotMixFrontAndBackOfAnEdge) {
  const std::vector frames{row({700}), row({760}), row({702}), row({761}), row({701})};
  const auto mean = mean_frame(frames);
  ASSERT_TRUE(mean);
  EXPECT_THAT(mean->depth, ElementsAre(7010));
}

TEST(MeanFrame, IsCoarserWhereDeepReadingsWouldNotFit) {
  const std::vector frames{row({20'000, 750}), row({20'001, 751})};
  const auto mean = mean_frame(frames);
  ASSERT_TRUE(mean);
  EXPECT_DOUBLE_EQ(mean->depth_scale_m, 0.001 / 3);
  EXPECT_THAT(mean->depth, ElementsAre(60'002, 2252));
}

TEST(MeanFrame, KeepsTheFirstFramesStamp) {
  using namespace std::chrono_literals;
  std::vector frames{row({750}), row({751})};
  frames[0].stamp = 5s;
  frames[1].stamp = 6s;
  EXPECT_EQ(mean_frame(frames)->stamp, 5s);
}

TEST(MeanFrame, RefusesFramesThatAreNotAlike) {
  std::vector frames{row({750}), row({751})};
  frames[1].depth_scale_m = 0.0001;
  const auto mean = mean_frame(frames);
  ASSERT_FALSE(mean);
  EXPECT_EQ(mean.error().code, Code::kInvalidArgument);
  EXPECT_THAT(mean.error().message, HasSubstr("frame 1"));
  EXPECT_FALSE(mean_frame(std::vector{row({750}), row({750, 751})}));
}

TEST(MeanFrame, RefusesNoneAndTooMany) {
  EXPECT_FALSE(mean_frame({}));
  EXPECT_FALSE(mean_frame(std::vector(kMaxMeanFrames + 1, row({750}))));
}

}  // namespace
}  // namespace graspd
