#include <gmock/gmock.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <atomic>
#include <limits>
#include <map>

#include "planner_fixture.hpp"

namespace graspd::perception {
namespace {

using Eigen::Vector3d;
using ::testing::AllOf;
using ::testing::HasSubstr;

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
  const auto numbers_with = [&](std::size_t threads_n) {
    const tbb::global_control threads(tbb::global_control::max_allowed_parallelism, threads_n);
    std::vector<double> numbers;
    const auto add = [&](const Eigen::Isometry3d& T, std::initializer_list<double> others) {
      numbers.insert(numbers.end(), T.data(), T.data() + T.matrix().size());
      numbers.insert(numbers.end(), others);
    };
    const auto answer = plan_of(frame);
    for (const Object& object : answer->objects) {
      add(object.T_base_part, {object.score, object.grs.grs});
    }
    for (const Grasp& grasp : answer->grasps) {
      add(grasp.T_base_grasp, {grasp.opening_width_m, grasp.room_m, grasp.score});
    }
    return numbers;
  };
  const auto one = numbers_with(1);
  ASSERT_FALSE(one.empty());
  for (const std::size_t threads_n : {1U, 2U, 4U}) {
    EXPECT_EQ(numbers_with(threads_n), one) << "to the bit, with " << threads_n << " threads";
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
  int asked_n = 0;
  const auto second = plan(frame, request_, catalogue_, parameters_, [&] {
    ++asked_n;
    return false;
  });
  ASSERT_TRUE(second);
  EXPECT_EQ(second->outcome, Outcome::kUnchanged);
  for (int most_n = 0; most_n < asked_n; ++most_n) {
    const auto late = plan(frame, request_, catalogue_, parameters_,
                           [&, left_n = most_n]() mutable { return left_n-- <= 0; });
    ASSERT_FALSE(late) << "asked " << most_n << " of " << asked_n << " times";
    EXPECT_EQ(late.error().code, Code::kDeadlineExceeded);
  }
  EXPECT_GE(asked_n, 2) << "before the objects are looked for, and after the grasps";
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

}  // namespace
}  // namespace graspd::perception
