#include "pick_cycle_fixture.hpp"

namespace graspd::agent {
namespace {

using namespace std::chrono_literals;
using testing::ElementsAre;
using testing::SizeIs;

TEST_F(PickCycleTest, EveryStateButTheLastOnesCanBeLeftAndReached) {
  for (const auto& [state, name] : EnumNames<State>::values) {
    const auto leaves = [&, s = state](const Transition& t) { return t.from == s; };
    const auto reaches = [&, s = state](const Transition& t) { return t.to == s; };
    const bool is_last = state == State::kDone || state == State::kStopped;
    EXPECT_EQ(std::none_of(std::begin(kTransitions), std::end(kTransitions), leaves), is_last)
        << name;
    EXPECT_TRUE(std::any_of(std::begin(kTransitions), std::end(kTransitions), reaches)) << name;
  }
}

TEST_F(PickCycleTest, NoEventLeadsTwoWays) {
  for (const Transition& a : kTransitions) {
    EXPECT_EQ(
        std::count_if(std::begin(kTransitions), std::end(kTransitions),
                      [&](const Transition& b) { return a.from == b.from && a.event == b.event; }),
        1)
        << name_of(a.from) << " on " << name_of(a.event);
  }
}

TEST_F(PickCycleTest, PicksPlacesAndTakesTheNextFrameUntilTheRecordingIsOver) {
  script({planned(), planned()});
  EXPECT_THAT(run(),
              ElementsAre("CLEAR_VIEW", "ACQUIRE", "PLAN", "PICK", "PLACE", "CLEAR_VIEW", "ACQUIRE",
                          "PLAN", "PICK", "PLACE", "CLEAR_VIEW", "ACQUIRE", "DONE"));
  EXPECT_EQ(reason, "no more frames after 2");
  EXPECT_THAT(planner.frames, SizeIs(2));
  EXPECT_EQ(planner.frames[1].at(0, 0), 1001);
}

TEST_F(PickCycleTest, TellsArmAndGripperTheStepsInOrder) {
  script({planned()});
  run();
  EXPECT_THAT(robot.told_all, ElementsAre("out_of_view", "open 0.044", "pre_grasp", "approach",
                                          "close", "lift", "holds?", "transfer", "holds?", "place",
                                          "open 0.044", "holds?", "retreat", "out_of_view"));
}

TEST_F(PickCycleTest, MotionsStandOffAlongTheApproachAndLiftStraightUp) {
  Grasp grasp = grasp_of(object_at(1, {0.1, 0.2, 0.3}));
  grasp.T_base_grasp.linear() =
      Eigen::AngleAxisd(0.5, Eigen::Vector3d::UnitX()).toRotationMatrix() *
      grasp.T_base_grasp.linear();
  const PickMotions motions = pick_motions(grasp, task.T_base_place);

  const Eigen::Vector3d p_base_m = grasp.T_base_grasp.translation();
  const Eigen::Vector3d approach = grasp.T_base_grasp.linear().col(2);
  const auto at = [](const Motion& motion) -> Eigen::Vector3d {
    return motion.T_base_grasp.translation();
  };
  EXPECT_TRUE(at(motions.pre_grasp).isApprox(p_base_m - 0.08 * approach));
  EXPECT_TRUE(motions.approach.T_base_grasp.isApprox(grasp.T_base_grasp));
  EXPECT_TRUE(at(motions.lift).isApprox(p_base_m + Eigen::Vector3d(0, 0, 0.10)));
  EXPECT_TRUE(at(motions.transfer).isApprox(Eigen::Vector3d(0, 0.5, 0.2)));
  EXPECT_TRUE(at(motions.place).isApprox(Eigen::Vector3d(0, 0.5, 0.1)));
  EXPECT_TRUE(motions.retreat.T_base_grasp.isApprox(motions.transfer.T_base_grasp));
  for (const Motion& motion : {motions.pre_grasp, motions.lift}) {
    EXPECT_TRUE(motion.T_base_grasp.linear().isApprox(grasp.T_base_grasp.linear()));
  }
  for (const Motion& motion : motions.all()) {
    const bool is_free = motion.step == Step::kPreGrasp || motion.step == Step::kTransfer;
    EXPECT_EQ(motion.path, is_free ? Path::kFree : Path::kStraight) << name_of(motion.step);
  }
}

TEST_F(PickCycleTest, RecordsOnePick) {
  script({planned()});
  run();
  ASSERT_THAT(records, SizeIs(1));
  const PickRecord& record = records[0];
  EXPECT_EQ(record.frame_n, 0u);
  EXPECT_EQ(record.request_id, "0123");
  EXPECT_EQ(record.code, Code::kOk);
  EXPECT_EQ(record.outcome, Outcome::kPlanned);
  EXPECT_EQ(record.objects_n, 3u);
  EXPECT_EQ(record.grasps_n, 3u);
  ASSERT_TRUE(record.chosen);
  EXPECT_EQ(record.chosen->pick_n, 1u);
  EXPECT_EQ(record.chosen->rank, 1u);
  EXPECT_EQ(record.chosen->part_id, "tee");
  EXPECT_EQ(record.chosen->grasp.object_id, 1u);
  EXPECT_EQ(record.chosen->grs.grs, 1.0);
  EXPECT_EQ(record.verdict, Verdict::kPlaced);
  // 33 ms a frame, 80 ms a plan, 100 ms for every order to the robot.
  EXPECT_EQ(record.acquire, 33ms);
  EXPECT_EQ(record.plan, 80ms);
  EXPECT_EQ(record.pick, 600ms);
  EXPECT_EQ(record.place, 600ms);
  EXPECT_EQ(record.clear_view, 100ms);
  ASSERT_THAT(record.server_timings, SizeIs(1));
  EXPECT_EQ(record.server_timings[0].stage, "registration");
}

TEST_F(PickCycleTest, SendsTheLastPlanAndThePickedPartWithTheNextRequest) {
  script({planned(), planned(Outcome::kUnchanged), planned()});
  run();
  ASSERT_THAT(planner.requests, SizeIs(3));
  EXPECT_FALSE(planner.requests[0].last_plan);
  for (const std::size_t next : {1u, 2u}) {
    const auto& last_plan = planner.requests[next].last_plan;
    ASSERT_TRUE(last_plan);
    EXPECT_EQ(last_plan->picked_object_id, 1u);
    ASSERT_THAT(last_plan->objects, SizeIs(3));
    const LastObject& second = last_plan->objects[1];
    const Object expected = object_at(2, {0.2, 0, 0});
    EXPECT_EQ(second.id, 2u);
    EXPECT_EQ(second.part_id, "elbow");
    EXPECT_TRUE(second.T_base_part.isApprox(expected.T_base_part));
    EXPECT_EQ(second.p_base_segment_centroid_m, expected.p_base_segment_centroid_m);
    EXPECT_EQ(second.score, 0.9);
    EXPECT_EQ(second.visible_fraction, 0.7);
  }
  EXPECT_EQ(records[1].outcome, Outcome::kUnchanged);
  EXPECT_EQ(records[1].verdict, Verdict::kPlaced);
}

TEST_F(PickCycleTest, SendsNoLastPlanThatTheServerWouldRefuse) {
  PlanAnswer crowded = planned();
  while (crowded.objects.size() <= kMaxLastObjects) {
    const auto id = static_cast<std::uint32_t>(crowded.objects.size() + 1);
    crowded.objects.push_back(object_at(id, {0.01 * id, 0, 0}));
  }
  script({planned(), crowded, planned()});
  run();
  ASSERT_THAT(planner.requests, SizeIs(3));
  EXPECT_TRUE(planner.requests[1].last_plan);
  EXPECT_FALSE(planner.requests[2].last_plan);
  EXPECT_EQ(records[1].verdict, Verdict::kPlaced);
}

TEST_F(PickCycleTest, KeepsWhatTheTaskAsksFor) {
  task.request.gripper.max_opening_m = 0.123;
  script({planned(), planned()});
  run();
  for (const PlanRequest& request : planner.requests) {
    EXPECT_EQ(request.gripper.max_opening_m, 0.123);
    EXPECT_THAT(request.parts, SizeIs(2));
  }
}

TEST_F(PickCycleTest, TakesTheBestGraspWithinReach) {
  PlanAnswer answer = planned();
  std::reverse(answer.grasps.begin(), answer.grasps.end());  // 0.3, 0.2, 0.1 m away
  script({answer});
  task.T_base_place.translation() = Eigen::Vector3d::Zero();
  robot.reach_m = 0.25;
  run();
  ASSERT_TRUE(records[0].chosen);
  EXPECT_EQ(records[0].chosen->rank, 2u);
  EXPECT_EQ(records[0].chosen->grasp.object_id, 2u);
}

TEST_F(PickCycleTest, AnEmptyBinIsTheEnd) {
  script({planned(), nothing(Outcome::kBinEmpty), planned()});
  EXPECT_EQ(run().back(), "DONE");
  EXPECT_EQ(reason, "BIN_EMPTY: so it is");
  ASSERT_THAT(records, SizeIs(2));
  EXPECT_EQ(records[1].outcome, Outcome::kBinEmpty);
  EXPECT_FALSE(records[1].verdict);
}

TEST_F(PickCycleTest, WhenAskedToFinishItPlacesThePartInHandAndTakesNoOther) {
  script({planned(), planned()});
  PickCycle cycle = make_cycle();
  while (cycle.state() != State::kPlace) cycle.step();
  cycle.finish();
  while (!cycle.is_over()) cycle.step();
  EXPECT_EQ(cycle.state(), State::kDone);
  EXPECT_EQ(cycle.reason(), "asked to stop");
  EXPECT_THAT(records, SizeIs(1));
  EXPECT_EQ(records[0].verdict, Verdict::kPlaced);
  EXPECT_EQ(robot.told_all.back(), "out_of_view");
}

}  // namespace
}  // namespace graspd::agent
