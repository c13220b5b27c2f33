#pragma once

#include <gtest/gtest.h>

#include <set>
#include <span>
#include <string>
#include <vector>

#include "block_scene.hpp"
#include "graspd/perception/planner.hpp"

namespace graspd::perception {

using ::testing::HasSubstr;

inline constexpr double kHeight_m = 0.75;
inline const Eigen::Vector3d kSize_m(0.10, 0.025, 0.025);

class Planner : public ::testing::Test {
 protected:
  Planner() {
    request_.T_base_camera = testing::T_base_camera_above(kHeight_m);
    request_.bin = Bin{Eigen::Isometry3d::Identity(), Eigen::Vector3d(0.40, 0.30, 0.15), 0.005};
    request_.parts = {{"block", 0}};
  }

  /// Blocks that show three faces each.
  static std::vector<testing::Block> pile(std::size_t count) {
    std::vector<testing::Block> blocks;
    for (std::size_t i = 0; i < count; ++i) {
      const std::size_t row = i / 3;
      Eigen::Isometry3d T_base_block = Eigen::Isometry3d::Identity();
      T_base_block.translate(Eigen::Vector3d(0.125 * static_cast<double>(i % 3) - 0.125,
                                             0.14 * static_cast<double>(row) - 0.07, 0.055));
      T_base_block.rotate(Eigen::AngleAxisd(0.6 + 0.3 * static_cast<double>(i),
                                            Eigen::Vector3d(1, 0.7, 0.4).normalized()));
      blocks.push_back({testing::T_base_camera_above(kHeight_m).inverse() * T_base_block, kSize_m});
    }
    return blocks;
  }
  static DepthFrame frame_of(const std::vector<testing::Block>& blocks) {
    return testing::render(testing::kinect_v2(), kHeight_m, blocks);
  }
  Result<PlanAnswer> plan_of(const DepthFrame& frame) {
    return plan(frame, request_, catalogue_, parameters_);
  }
  std::string refusal(const DepthFrame& frame, Code code = Code::kInvalidArgument) {
    const auto answer = plan_of(frame);
    if (answer) return "accepted";
    EXPECT_EQ(answer.error().code, code);
    return answer.error().message;
  }

  parts::Catalogue catalogue_ = [] {
    std::vector<parts::Part> parts;
    parts.push_back(testing::block_part("block", kSize_m));
    return parts::Catalogue(std::move(parts));
  }();
  Parameters parameters_;
  PlanRequest request_;
};

/// The leading grasps of different objects: the second one of any comes after them all.
inline std::span<const Grasp> first_of_each_object(const std::vector<Grasp>& grasps) {
  std::set<std::uint32_t> ids;
  std::size_t count = 0;
  while (count < grasps.size() && ids.insert(grasps[count].object_id).second) ++count;
  return std::span(grasps).first(count);
}

}  // namespace graspd::perception
