#include <gmock/gmock.h>

#include "graspd/recorded/answer_diff.hpp"

namespace graspd::recorded {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::SizeIs;

Object object(std::uint32_t id, const std::string& part, double x_m) {
  Object object;
  object.id = id;
  object.part_id = part;
  object.T_base_part.translation().x() = x_m;
  return object;
}

Grasp grasp(std::uint32_t object_id, double x_m, double score) {
  Grasp grasp;
  grasp.object_id = object_id;
  grasp.pick_point = "principal_axis";
  grasp.T_base_grasp.translation().x() = x_m;
  grasp.opening_width_m = 0.03;
  grasp.score = score;
  return grasp;
}

/// Three parts in a row, each with a grasp.
PlanAnswer answer() {
  PlanAnswer answer;
  answer.funnel.segments_n = 3;
  answer.funnel.after_plane_n = 3000;
  for (std::uint32_t i = 0; i < 3; ++i) {
    answer.objects.push_back(object(i + 1, i == 2 ? "elbow" : "tee", 0.1 * i));
    answer.grasps.push_back(grasp(i + 1, 0.1 * i, 1.0 - 0.1 * i));
  }
  return answer;
}

TEST(AnswerDiff, TimingsAndServersAreNoDifference) {
  PlanAnswer now = answer();
  now.timings.push_back({"preprocess", 5});
  now.server.build = "another";
  const AnswerDiff same = diff(answer(), now);
  EXPECT_TRUE(same.is_same());
  EXPECT_FALSE(same.since);
}

TEST(AnswerDiff, AnyOtherBitIs) {
  PlanAnswer now = answer();
  now.grasps[1].room_m = 1e-300;
  const AnswerDiff difference = diff(answer(), now);
  EXPECT_FALSE(difference.is_same());
  EXPECT_EQ(difference.since, Stage::kGrasps);
  EXPECT_THAT(difference.grasps, SizeIs(1));
  now = answer();
  now.warnings = {"the bin has drifted"};
  EXPECT_FALSE(diff(answer(), now).is_same());
  EXPECT_FALSE(diff(answer(), now).since) << "no stage's result differs";
}

TEST(AnswerDiff, NamesTheFirstStageThatDiffers) {
  const auto since = [](const auto& change) {
    PlanAnswer now = answer();
    // What comes last differs as well, as it would.
    now.grasps[0].score = 0.5;
    now.objects[0].grs.grs = 0.5;
    change(now);
    return diff(answer(), now);
  };
  EXPECT_EQ(since([](PlanAnswer&) {}).since, Stage::kGrasps);
  EXPECT_THAT(since([](PlanAnswer&) {}).what, HasSubstr("object 1 (tee) GRS 0, now 0.5"));
  const auto registration = [](PlanAnswer& now) {
    now.objects[2].T_base_part.translation().z() = 0.001;
  };
  EXPECT_EQ(since(registration).since, Stage::kRegistration);
  EXPECT_THAT(since(registration).what, HasSubstr("object 3 (elbow) moved by 1 mm"));
  EXPECT_EQ(since([](PlanAnswer& now) { now.objects.pop_back(); }).since, Stage::kRegistration);
  const auto segmentation = [&](PlanAnswer& now) {
    registration(now);
    now.funnel.segments_n = 2;
  };
  EXPECT_EQ(since(segmentation).since, Stage::kSegmentation);
  EXPECT_EQ(since(segmentation).what, "segments_n 3, now 2");
  const auto displacement = [&](PlanAnswer& now) {
    segmentation(now);
    now.outcome = Outcome::kUnchanged;
    now.reason = "nothing has moved";
  };
  EXPECT_EQ(since(displacement).since, Stage::kDisplacement);
  const auto preprocess = [&](PlanAnswer& now) {
    displacement(now);
    now.fill_level = 0.3;
  };
  EXPECT_EQ(since(preprocess).since, Stage::kPreprocess);
  EXPECT_EQ(since(preprocess).what, "fill_level none, now 0.3");
}

TEST(AnswerDiff, OutlinesAloneAreTheirOwnStage) {
  PlanAnswer now = answer();
  now.objects[1].outline_px = {1, 2};
  EXPECT_EQ(diff(answer(), now).since, Stage::kOutlines);
  EXPECT_THAT(diff(answer(), now).grasps, IsEmpty());
}

TEST(AnswerDiff, SaysOfAGraspHowFarItMovedAndTurned) {
  PlanAnswer now = answer();
  Grasp& moved = now.grasps[1];
  moved.T_base_grasp.translation().y() = 0.003;
  moved.T_base_grasp.rotate(Eigen::AngleAxisd(0.1, Eigen::Vector3d::UnitZ()));
  moved.opening_width_m = 0.032;
  moved.score = 0.8;
  const AnswerDiff difference = diff(answer(), now);
  ASSERT_THAT(difference.grasps, SizeIs(1));
  const GraspChange& change = difference.grasps[0];
  EXPECT_EQ(change.old_rank, 2u);
  EXPECT_EQ(change.new_rank, 2u);
  EXPECT_EQ(change.part_id, "tee");
  EXPECT_NEAR(change.moved_m, 0.003, 1e-12);
  EXPECT_NEAR(change.turned_rad, 0.1, 1e-9);
  EXPECT_NEAR(change.opened_m, 0.002, 1e-12);
  EXPECT_EQ(change.old_score, 0.9);
  EXPECT_EQ(change.new_score, 0.8);
}

TEST(AnswerDiff, GraspsThatChangePlacesAreFoundAgain) {
  PlanAnswer now = answer();
  std::swap(now.grasps[0], now.grasps[2]);
  const AnswerDiff difference = diff(answer(), now);
  ASSERT_THAT(difference.grasps, SizeIs(2));
  EXPECT_EQ(difference.grasps[0].old_rank, 3u);
  EXPECT_EQ(difference.grasps[0].new_rank, 1u);
  EXPECT_EQ(difference.grasps[1].old_rank, 1u);
  EXPECT_EQ(difference.grasps[1].new_rank, 3u);
}

TEST(AnswerDiff, GraspsComeAndGo) {
  PlanAnswer now = answer();
  now.grasps[0].T_base_grasp.translation().y() = 0.05;  // too far to be the same one
  now.grasps.push_back(grasp(3, 0.2, 0.1));             // a second one of the same part
  const AnswerDiff difference = diff(answer(), now);
  ASSERT_THAT(difference.grasps, SizeIs(3));
  EXPECT_FALSE(difference.grasps[0].old_rank);
  EXPECT_EQ(difference.grasps[0].new_rank, 1u);
  EXPECT_FALSE(difference.grasps[1].old_rank);
  EXPECT_EQ(difference.grasps[1].new_rank, 4u);
  EXPECT_EQ(difference.grasps[2].old_rank, 1u);
  EXPECT_FALSE(difference.grasps[2].new_rank);
}

TEST(AnswerDiff, AGraspOfAnotherPartIsAnotherGrasp) {
  PlanAnswer now = answer();
  now.objects[0].part_id = "elbow";
  const AnswerDiff difference = diff(answer(), now);
  ASSERT_THAT(difference.grasps, SizeIs(2));
  EXPECT_FALSE(difference.grasps[0].old_rank);
  EXPECT_FALSE(difference.grasps[1].new_rank);
}

}  // namespace
}  // namespace graspd::recorded
