#include "graspd/perception/planner.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <atomic>
#include <limits>
#include <map>
#include <set>
#include <span>

#include "block_scene.hpp"

namespace graspd::perception {
namespace {

using Eigen::Vector3d;
using ::testing::AllOf;
using ::testing::HasSubstr;

constexpr double kHeight_m = 0.75;
const Vector3d kSize_m(0.10, 0.025, 0.025);

class Planner : public ::testing::Test {
 protected:
  Planner() {
    request_.T_base_camera = testing::T_base_camera_above(kHeight_m);
    request_.bin = Bin{Eigen::Isometry3d::Identity(), Vector3d(0.40, 0.30, 0.15), 0.005};
    request_.parts = {{"block", 0}};
  }

  /// Blocks that show three faces each.
  static std::vector<testing::Block> pile(std::size_t count) {
    std::vector<testing::Block> blocks;
    for (std::size_t i = 0; i < count; ++i) {
      const std::size_t row = i / 3;
      Eigen::Isometry3d T_base_block = Eigen::Isometry3d::Identity();
      T_base_block.translate(Vector3d(0.125 * static_cast<double>(i % 3) - 0.125,
                                      0.14 * static_cast<double>(row) - 0.07, 0.055));
      T_base_block.rotate(Eigen::AngleAxisd(0.6 + 0.3 * static_cast<double>(i),
                                            Vector3d(1, 0.7, 0.4).normalized()));
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
std::span<const Grasp> first_of_each_object(const std::vector<Grasp>& grasps) {
  std::set<std::uint32_t> ids;
  std::size_t count = 0;
  while (count < grasps.size() && ids.insert(grasps[count].object_id).second) ++count;
  return std::span(grasps).first(count);
}

TEST_F(Planner, AnswersRankedGraspsWithTheirEvidence) {
  const auto answer = plan_of(frame_of(pile(6)));
  ASSERT_TRUE(answer) << answer.error().message;
  EXPECT_EQ(answer->outcome, Outcome::kPlanned) << answer->reason;
  ASSERT_GE(answer->objects.size(), 3U);
  ASSERT_FALSE(answer->grasps.empty());
  const auto first = first_of_each_object(answer->grasps);
  EXPECT_EQ(first.size(), answer->objects.size());
  for (std::size_t i = 1; i < first.size(); ++i) EXPECT_GE(first[i - 1].score, first[i].score);
  for (const Object& object : answer->objects) {
    EXPECT_EQ(object.part_id, "block");
    EXPECT_GE(object.score, parameters_.registration.min_score);
    EXPECT_LE(object.score, 1);
    EXPECT_LE(object.grs.neighbour_ids.size(), 4U);
  }
  EXPECT_EQ(answer->funnel.segments_n, 6U);
  EXPECT_EQ(answer->funnel.registered_n, answer->objects.size());
  std::vector<std::string> stages;
  for (const auto& timing : answer->timings) stages.push_back(timing.stage);
  EXPECT_THAT(stages, ::testing::ElementsAre("preprocess", "displacement", "segmentation",
                                             "registration", "grasps"));
}

TEST_F(Planner, AnswersTheSameWhateverTheThreads) {
  const DepthFrame frame = frame_of(pile(6));
  const auto poses_with = [&](std::size_t threads_n) {
    const tbb::global_control threads(tbb::global_control::max_allowed_parallelism, threads_n);
    std::vector<Eigen::Matrix4d> poses;
    const auto answer = plan_of(frame);
    for (const Object& object : answer->objects) {
      poses.emplace_back(object.T_base_part.matrix());
    }
    return poses;
  };
  const auto one = poses_with(1);
  for (const std::size_t threads_n : {1U, 2U, 4U}) {
    const auto many = poses_with(threads_n);
    ASSERT_EQ(many.size(), one.size());
    for (std::size_t i = 0; i < one.size(); ++i) EXPECT_EQ(many[i], one[i]) << "to the bit";
  }
}

TEST_F(Planner, EndsWithoutAnAnswerOnceItIsLate) {
  const DepthFrame frame = frame_of(pile(6));
  for (const Registration method : {Registration::kVerified, Registration::kPcaIcp}) {
    parameters_.registration.method = method;
    std::atomic<int> asked_n = 0;
    const auto late_after = [&](int most_n) {
      asked_n = 0;
      return plan(frame, request_, catalogue_, parameters_, [&] { return ++asked_n > most_n; });
    };
    ASSERT_TRUE(late_after(std::numeric_limits<int>::max()));
    const int all_n = asked_n;
    EXPECT_GE(all_n, 3 + 6) << "before each stage, and at least for each part";
    for (const int most_n : {0, 1, 2, all_n / 2, all_n - 1}) {
      const auto answer = late_after(most_n);
      ASSERT_FALSE(answer) << "asked " << most_n << " of " << all_n << " times";
      EXPECT_EQ(answer.error().code, Code::kDeadlineExceeded);
      EXPECT_THAT(answer.error().message, HasSubstr("(preprocess "));
      EXPECT_LT(asked_n, most_n + 1 + 8) << "and then soon";
    }
  }
}

TEST_F(Planner, AnEmptyBinIsSaidToBeEmpty) {
  const auto answer = plan_of(frame_of({}));
  ASSERT_TRUE(answer);
  EXPECT_EQ(answer->outcome, Outcome::kBinEmpty);
  EXPECT_THAT(answer->reason, HasSubstr("too few for a part"));
  EXPECT_TRUE(answer->grasps.empty());
}

TEST_F(Planner, ABinElsewhereIsSaidToBeMissing) {
  request_.bin->T_base_bin.translation() = Vector3d(0, 0, 0.4);
  const auto answer = plan_of(frame_of(pile(2)));
  ASSERT_TRUE(answer);
  EXPECT_EQ(answer->outcome, Outcome::kBinNotFound);
  EXPECT_THAT(answer->reason, HasSubstr("T_base_bin"));
}

TEST_F(Planner, SomethingElseInTheBinIsNotAPart) {
  testing::Block slab{
      testing::T_base_camera_above(kHeight_m).inverse() * Eigen::Translation3d(0, 0, 0.05),
      Vector3d(0.25, 0.2, 0.1)};
  const auto answer = plan_of(frame_of({slab}));
  ASSERT_TRUE(answer);
  EXPECT_EQ(answer->outcome, Outcome::kNoneRegistered);
  EXPECT_TRUE(answer->objects.empty());
  EXPECT_THAT(answer->reason, HasSubstr("the best, of part 'block', has "));
}

TEST_F(Planner, ATooNarrowGripperIsAllInCollisionWithTheReason) {
  request_.gripper.max_opening_m = 0.02;
  request_.options.explain_rejected = true;
  const auto answer = plan_of(frame_of(pile(3)));
  ASSERT_TRUE(answer);
  EXPECT_EQ(answer->outcome, Outcome::kAllInCollision);
  EXPECT_THAT(answer->reason, HasSubstr("opening: the part is"));
  EXPECT_EQ(answer->rejected_grasps.size(), answer->objects.size());
  EXPECT_GE(answer->funnel.rejected_by_check_n[0], answer->objects.size());
}

TEST_F(Planner, EveryGraspSaysWhichChecksRan) {
  const DepthFrame frame = frame_of(pile(6));
  for (const bool is_on : {true, false}) {
    parameters_.collision.gripper_cloud = is_on;
    const auto answer = plan_of(frame);
    ASSERT_TRUE(answer);
    ASSERT_FALSE(answer->grasps.empty());
    std::map<std::uint32_t, int> grasps_n;
    for (const Grasp& grasp : answer->grasps) {
      ++grasps_n[grasp.object_id];
      ASSERT_EQ(grasp.checks.size(), std::size(EnumNames<Check>::values));
      for (const CheckReport& check : grasp.checks) {
        const bool is_off = check.check == Check::kGripperCloud && !is_on;
        EXPECT_EQ(check.state, is_off ? CheckState::kNotRun : CheckState::kPassed)
            << name_of(check.check) << ": " << check.reason;
      }
    }
    for (const auto& [id, count_n] : grasps_n) {
      EXPECT_LE(count_n, parameters_.grasp.grasps_per_part_n) << "object " << id;
    }
  }
}

TEST_F(Planner, ThePapersPreprocessingIsCheckedAgainstTheImageToo) {
  parameters_.segmentation.method = Segmentation::kImprovedDbscan;
  const auto answer = plan_of(frame_of(pile(3)));
  ASSERT_TRUE(answer);
  ASSERT_FALSE(answer->grasps.empty());
  for (const CheckReport& check : answer->grasps.front().checks) {
    EXPECT_EQ(check.state, CheckState::kPassed) << name_of(check.check) << ": " << check.reason;
  }
}

TEST_F(Planner, AGripperWiderThanTheBinIsAllInCollisionWithTheReason) {
  request_.gripper.palm_size_m = Vector3d(0.5, 0.5, 0.3);
  request_.options.explain_rejected = true;
  const auto answer = plan_of(frame_of(pile(3)));
  ASSERT_TRUE(answer);
  EXPECT_EQ(answer->outcome, Outcome::kAllInCollision);
  EXPECT_THAT(answer->reason, HasSubstr("gripper_bin: "));
  EXPECT_FALSE(answer->rejected_grasps.empty());
  EXPECT_GE(answer->funnel.rejected_by_check_n[static_cast<std::size_t>(Check::kGripperBin)],
            answer->objects.size());
}

TEST_F(Planner, TheLastPlanOfAnUntouchedBinStands) {
  const DepthFrame frame = frame_of(pile(4));
  const auto first = plan_of(frame);
  ASSERT_TRUE(first);
  ASSERT_GE(first->objects.size(), 2U);
  request_.last_plan.emplace();
  for (const Object& object : first->objects) {
    request_.last_plan->objects.push_back({object.id, object.part_id, object.T_base_part,
                                           object.p_base_segment_centroid_m, object.score,
                                           object.visible_fraction});
  }
  const auto second = plan_of(frame);
  ASSERT_TRUE(second);
  EXPECT_EQ(second->outcome, Outcome::kUnchanged);
  ASSERT_EQ(second->objects.size(), first->objects.size());
  EXPECT_EQ(second->funnel.hypotheses_n, 0U) << "nothing was registered again";
  ASSERT_EQ(second->grasps.size(), first->grasps.size());
  for (std::size_t i = 0; i < first->grasps.size(); ++i) {
    EXPECT_EQ(second->grasps[i].object_id, first->grasps[i].object_id);
  }
}

TEST_F(Planner, AMovedPartIsPlannedAnew) {
  std::vector<testing::Block> blocks = pile(4);
  const auto first = plan_of(frame_of(blocks));
  ASSERT_TRUE(first);
  request_.last_plan.emplace();
  for (const Object& object : first->objects) {
    request_.last_plan->objects.push_back({object.id, object.part_id, object.T_base_part,
                                           object.p_base_segment_centroid_m, object.score,
                                           object.visible_fraction});
  }
  for (testing::Block& block : blocks) block.T_camera_block.pretranslate(Vector3d(0.01, 0, 0));
  const auto second = plan_of(frame_of(blocks));
  ASSERT_TRUE(second);
  EXPECT_EQ(second->outcome, Outcome::kPlanned);
  EXPECT_GT(second->funnel.hypotheses_n, 0U);
}

TEST_F(Planner, AFailedSpotIsRankedLast) {
  const DepthFrame frame = frame_of(pile(6));
  const auto first = plan_of(frame);
  ASSERT_TRUE(first);
  ASSERT_GE(first->grasps.size(), 2U);
  FailedSpot spot;
  spot.p_base_m = first->grasps.front().T_base_grasp.translation();
  request_.failed_spots = {spot};
  const auto second = plan_of(frame);
  ASSERT_TRUE(second);
  const std::uint32_t failed_id = first->grasps.front().object_id;
  const auto next = std::ranges::find_if(
      first->grasps, [&](const Grasp& grasp) { return grasp.object_id != failed_id; });
  ASSERT_NE(next, first->grasps.end());
  EXPECT_EQ(second->grasps.back().object_id, failed_id);
  EXPECT_EQ(second->grasps.front().object_id, next->object_id);
}

TEST_F(Planner, StrategiesOrderByWhatTheySay) {
  const DepthFrame frame = frame_of(pile(6));
  request_.options.strategy = Strategy::kNearest;
  request_.options.strategy_vector_base_m = Vector3d(0.2, 0.2, 0);
  const auto answer = plan_of(frame);
  ASSERT_TRUE(answer);
  ASSERT_GE(answer->grasps.size(), 2U);
  double last_m = 0;
  for (const Grasp& grasp : first_of_each_object(answer->grasps)) {
    const double distance_m = (grasp.T_base_grasp.translation() - Vector3d(0.2, 0.2, 0)).norm();
    EXPECT_GE(distance_m, last_m);
    last_m = distance_m;
  }
}

TEST_F(Planner, OutlinesSurroundTheParts) {
  request_.options.outlines = true;
  const DepthFrame frame = frame_of(pile(3));
  const auto answer = plan_of(frame);
  ASSERT_TRUE(answer);
  ASSERT_FALSE(answer->objects.empty());
  for (const Object& object : answer->objects) {
    ASSERT_GE(object.outline_px.size(), 8U);
    ASSERT_EQ(object.outline_px.size() % 2, 0U);
    const Eigen::Vector2d centre = project(
        frame.camera, (request_.T_base_camera.inverse() * object.T_base_part).translation());
    Eigen::AlignedBox2d box;
    for (std::size_t i = 0; i < object.outline_px.size(); i += 2) {
      box.extend(Eigen::Vector2d(object.outline_px[i], object.outline_px[i + 1]));
    }
    EXPECT_TRUE(box.contains(centre));
    // The block's diagonal at its distance, in both directions at the most.
    EXPECT_LT(box.diagonal().norm(), 365.5 * kSize_m.norm() / 0.6 * std::sqrt(2.0));
  }
}

TEST_F(Planner, BadFramesAreNamed) {
  DepthFrame frame = frame_of({});
  frame.depth.clear();
  EXPECT_THAT(refusal(frame), HasSubstr("0 depth values for an image of 512 × 424"));
  frame.depth.assign(512 * 424, 0);
  EXPECT_THAT(refusal(frame), HasSubstr("are 0, which means no reading"));
  frame = frame_of({});
  frame.camera.fx_px = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THAT(refusal(frame), AllOf(HasSubstr("camera.fx_px"), HasSubstr("nan")));
  frame.camera.fx_px = 0;
  EXPECT_THAT(refusal(frame), HasSubstr("camera.fx_px: 0 is no focal length"));
  frame = frame_of({});
  frame.camera.cx_px = 5000;
  EXPECT_THAT(refusal(frame), HasSubstr("principal point"));
  frame = frame_of({});
  frame.camera.width_px = 640;
  EXPECT_THAT(refusal(frame), HasSubstr("640 × 424 = 271360 pixels"));
  frame = frame_of({});
  frame.depth_scale_m = 1;
  EXPECT_THAT(refusal(frame), HasSubstr("depth_scale_m"));
}

TEST_F(Planner, BadRequestsAreNamed) {
  const DepthFrame frame = frame_of({});
  const PlanRequest good = request_;
  const auto with = [&](auto change) {
    request_ = good;
    change(request_);
  };
  with([](PlanRequest& r) { r.parts = {{"gear", 0}}; });
  EXPECT_THAT(refusal(frame, Code::kUnknownPart), HasSubstr("no part 'gear' in the catalogue"));
  with([](PlanRequest& r) { r.parts.clear(); });
  EXPECT_THAT(refusal(frame), HasSubstr("parts: none requested"));
  with([](PlanRequest& r) { r.bin->T_base_bin.translation().z() = 2; });
  EXPECT_THAT(refusal(frame), HasSubstr("behind the camera"));
  with([](PlanRequest& r) { r.T_base_camera.translation().x() = 750; });
  EXPECT_THAT(refusal(frame), HasSubstr("in metres, not millimetres"));
  with([](PlanRequest& r) { r.T_base_camera.linear() *= 2; });
  EXPECT_THAT(refusal(frame), HasSubstr("T_base_camera: not a rotation"));
  with([](PlanRequest& r) { r.bin->inner_size_m.x() = -1; });
  EXPECT_THAT(refusal(frame), HasSubstr("bin.inner_size_m"));
  with([](PlanRequest& r) { r.gripper.max_opening_m = 0; });
  EXPECT_THAT(refusal(frame), HasSubstr("max_opening_m"));
  with([](PlanRequest& r) { r.crop_box = CropBox{{}, Vector3d::Ones()}; });
  EXPECT_THAT(refusal(frame), HasSubstr("bin and crop_box"));
  with([](PlanRequest& r) { r.failed_spots.resize(1000); });
  EXPECT_THAT(refusal(frame), HasSubstr("failed_spots: 1000"));
  with([](PlanRequest& r) {
    r.last_plan.emplace();
    r.last_plan->objects.resize(2);
  });
  EXPECT_THAT(refusal(frame), HasSubstr("stands twice"));
}

TEST_F(Planner, ASuctionCupHoldsFlatPlacesThatFaceUp) {
  Eigen::Isometry3d T_base_block = Eigen::Isometry3d::Identity();
  T_base_block.translate(Vector3d(0.03, 0.02, kSize_m.z() / 2));
  const DepthFrame frame =
      frame_of({{testing::T_base_camera_above(kHeight_m).inverse() * T_base_block, kSize_m}});
  std::vector<parts::Part> parts;
  parts.push_back(testing::block_part("block", kSize_m));
  for (const double side : {1, -1}) {
    parts::PickPoint& face = parts[0].pick_points.emplace_back();
    face.name = "flat";
    face.position_m = Vector3d(0, 0, side * kSize_m.z() / 2);
    face.approach = Vector3d(0, 0, -side);
    face.width_m = 0.02;
    face.gripper = "suction";
  }
  const parts::Catalogue catalogue(std::move(parts));
  request_.gripper.kind = GripperKind::kSuction;
  request_.gripper.cup_diameter_m = 0.015;
  const auto answer = plan(frame, request_, catalogue, parameters_);
  ASSERT_TRUE(answer) << answer.error().message;
  ASSERT_EQ(answer->outcome, Outcome::kPlanned) << answer->reason;
  const Grasp& grasp = answer->grasps.front();
  EXPECT_EQ(grasp.pick_point, "flat");
  EXPECT_EQ(grasp.opening_width_m, 0);
  EXPECT_LT(grasp.T_base_grasp.linear().col(2).z(), -0.95) << "from above";
  EXPECT_NEAR(grasp.T_base_grasp.translation().z(), kSize_m.z(), 0.003) << "on its upper face";

  request_.gripper.cup_diameter_m = 0.2;
  const auto too_large = plan(frame, request_, catalogue, parameters_);
  ASSERT_TRUE(too_large) << too_large.error().message;
  EXPECT_EQ(too_large->outcome, Outcome::kAllInCollision);
  EXPECT_THAT(too_large->reason, HasSubstr("cup of 200.0 mm"));
}

}  // namespace
}  // namespace graspd::perception
