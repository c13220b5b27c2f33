#include "pick_cycle_fixture.hpp"

/// Old frames, grasps that the arm can't take, grippers that don't confirm, ports that break.
namespace graspd::agent {
namespace {

using namespace std::chrono_literals;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;

class OldFrames : public PickCycleTest {
 protected:
  /// A frame taken this long before or after the start of the clock.
  static DepthFrame taken_at(std::chrono::nanoseconds stamp, std::uint16_t depth = 1000) {
    DepthFrame frame = fakes::frame_of(depth);
    frame.stamp = stamp;
    return frame;
  }
};

TEST_F(OldFrames, AreAskedForAgainUntilOneIsFresh) {
  // The arm is out of view after 100 ms.
  camera.script = {taken_at(20ms, 1), taken_at(99ms, 2), taken_at(150ms, 3)};
  planner.script = {planned()};
  EXPECT_EQ(run().back(), "DONE");
  ASSERT_THAT(planner.frames, SizeIs(1));
  EXPECT_EQ(planner.frames[0].at(0, 0), 3);
  EXPECT_EQ(records.at(0).acquire, 3 * 33ms + 2 * 33ms) << "with a frame time between the tries";
}

TEST_F(OldFrames, OnlyAreAFaultOfTheCamera) {
  task.retry.max_old_frames_n = 4;
  for (int i = 0; i < 10; ++i) camera.script.emplace_back(taken_at(20ms));
  EXPECT_EQ(run().back(), "STOPPED");
  EXPECT_THAT(camera.script, SizeIs(5)) << "asked once, and four times again";
  EXPECT_THAT(reason,
              HasSubstr("camera: 5 frames in a row are from before the cell's last motion"));
  EXPECT_THAT(reason, HasSubstr("by 0.08 s"));
  EXPECT_EQ(robot.told_all.back(), "stop");
}

TEST_F(OldFrames, AfterAPickAreFromBeforeItsLastMotion) {
  task.retry.max_old_frames_n = 0;
  camera.script = {taken_at(150ms), taken_at(160ms)};
  planner.script = {planned(), planned()};
  EXPECT_EQ(run().back(), "STOPPED");
  EXPECT_THAT(reason, HasSubstr("camera: 1 frames in a row"));
  EXPECT_THAT(planner.frames, SizeIs(1));
}

TEST_F(OldFrames, AfterAPauseShowNothingNew) {
  task.retry.max_old_frames_n = 0;
  camera.script = {taken_at(150ms), taken_at(150ms)};
  planner.script = {nothing(Outcome::kNoneRegistered)};
  EXPECT_EQ(run().back(), "STOPPED");
  EXPECT_THAT(clock.sleeps, SizeIs(1));
}

TEST_F(PickCycleTest, AGraspThatTheArmCanNotTakeIsPassedOverAndWhyGoesEverywhere) {
  PlanAnswer answer = planned();
  std::reverse(answer.grasps.begin(), answer.grasps.end());  // 0.3, 0.2, 0.1 m away
  answer.grasps[0].pick_point = "flange";
  script({answer, planned()});
  task.T_base_place.translation() = Eigen::Vector3d::Zero();
  robot.reach_m = 0.25;
  run();
  ASSERT_THAT(records[0].passed_over, SizeIs(1));
  const PassedOver& over = records[0].passed_over[0];
  EXPECT_EQ(over.rank, 1u);
  EXPECT_EQ(over.object_id, 3u);
  EXPECT_EQ(over.part_id, "tee");
  EXPECT_EQ(over.pick_point, "flange");
  EXPECT_EQ(over.reason, "pre_grasp is out of reach");
  // The next request says so too, and ranks that very grasp down, not its neighbours.
  ASSERT_THAT(planner.requests[1].failed_spots, SizeIs(1));
  const FailedSpot& spot = planner.requests[1].failed_spots[0];
  EXPECT_EQ(spot.reason, over.reason);
  EXPECT_TRUE(spot.p_base_m.isApprox(Eigen::Vector3d(0.3, 0, 0)));
  EXPECT_LT(spot.radius_m, task.failed_spot_radius_m);
}

TEST_F(PickCycleTest, WhatWasPassedOverIsForgottenWithTheNextPlan) {
  script({planned(), planned(), planned()});
  robot.cannot = "pre_grasp";
  PickCycle cycle = make_cycle();
  while (cycle.state() != State::kPause) cycle.step();
  robot.cannot.clear();
  while (!cycle.is_over()) cycle.step();
  EXPECT_THAT(planner.requests[1].failed_spots, SizeIs(3));
  EXPECT_THAT(planner.requests[2].failed_spots, IsEmpty());
}

TEST_F(PickCycleTest, OfALastPlanThatStandsOutOfReachAllIsRegisteredAnewAtOnce) {
  PlanAnswer standing = planned(Outcome::kUnchanged);
  for (Grasp& grasp : standing.grasps) grasp.T_base_grasp.translation().x() += 100;
  script({planned(), standing});
  planner.script.emplace_back(planned());
  EXPECT_THAT(run(),
              ElementsAre("CLEAR_VIEW", "ACQUIRE", "PLAN", "PICK", "PLACE", "CLEAR_VIEW", "ACQUIRE",
                          "PLAN", "PLAN", "PICK", "PLACE", "CLEAR_VIEW", "ACQUIRE", "DONE"));
  EXPECT_TRUE(planner.requests[1].last_plan);
  EXPECT_FALSE(planner.requests[2].last_plan);
  EXPECT_EQ(planner.frames[2].at(0, 0), planner.frames[1].at(0, 0)) << "the same frame";
  ASSERT_THAT(records, SizeIs(2));
  EXPECT_EQ(records[1].plan, 160ms);
  EXPECT_THAT(records[1].passed_over, IsEmpty());
}

TEST_F(PickCycleTest, UnchangedPlansCarryAWholeBin) {
  // Six objects; each pick takes the best away, and the server finds the others where they were.
  std::vector<Result<PlanAnswer>> answers;
  for (std::uint32_t picked_n = 0; picked_n < 6; ++picked_n) {
    PlanAnswer answer;
    answer.outcome = picked_n == 0 ? Outcome::kPlanned : Outcome::kUnchanged;
    for (std::uint32_t id = picked_n + 1; id <= 6; ++id) {
      answer.objects.push_back(object_at(id, {0.1 * id, 0, 0}));
      answer.grasps.push_back(grasp_of(answer.objects.back()));
    }
    answers.emplace_back(std::move(answer));
  }
  answers.emplace_back(nothing(Outcome::kBinEmpty));
  script(std::move(answers));
  EXPECT_EQ(run().back(), "DONE");
  ASSERT_THAT(records, SizeIs(7));
  for (std::uint32_t i = 1; i <= 6; ++i) {
    EXPECT_EQ(records[i - 1].verdict, Verdict::kPlaced);
    EXPECT_EQ(records[i - 1].chosen->grasp.object_id, i);
    const auto& last_plan = planner.requests[i].last_plan;
    ASSERT_TRUE(last_plan);
    EXPECT_THAT(last_plan->objects, SizeIs(7 - i));
    EXPECT_EQ(last_plan->picked_object_id, i);
  }
}

TEST_F(PickCycleTest, AReasonIsCutToWhatARequestMayCarry) {
  PickMemory memory(0.02);
  const std::string long_reason = std::string(126, 'x') + "äöü";
  memory.passed_over(grasp_of(object_at(1, {0.1, 0, 0})), "line one\nline two\x7f");
  memory.passed_over(grasp_of(object_at(2, {0.2, 0, 0})), long_reason);
  memory.passed_over(grasp_of(object_at(3, {0.3, 0, 0})), "x" + long_reason);
  PlanRequest request = task.request;
  memory.add_to(request);
  EXPECT_EQ(request.failed_spots[0].reason, "line one line two ");
  EXPECT_EQ(request.failed_spots[1].reason, long_reason.substr(0, 128));
  EXPECT_EQ(request.failed_spots[2].reason, "x" + long_reason.substr(0, 126))
      << "no half a character";
}

TEST_F(PickCycleTest, NoMoreSpotsAreSentThanARequestTakes) {
  PickMemory memory(0.001);
  for (std::uint32_t i = 0; i < kMaxFailedSpots - 1; ++i) {
    memory.failed(grasp_of(object_at(1, {0.01 * i, 0, 0})));
  }
  memory.passed_over(grasp_of(object_at(1, {9, 0, 0})), "first");
  memory.passed_over(grasp_of(object_at(1, {9, 0, 0})), "second");
  PlanRequest request;
  memory.add_to(request);
  ASSERT_THAT(request.failed_spots, SizeIs(kMaxFailedSpots));
  EXPECT_EQ(request.failed_spots.back().reason, "first");
}

TEST_F(PickCycleTest, TheArmKnowsItsSurroundingsBeforeItIsAskedForAWay) {
  task.request.T_base_camera.linear() = Eigen::Vector3d(1, -1, -1).asDiagonal();
  task.request.bin = Bin{Eigen::Isometry3d(Eigen::Translation3d(0, 0, -1.05)), {2, 2, 0.2}, 0};
  script({planned()});
  run();
  ASSERT_TRUE(robot.surroundings.bin);
  EXPECT_THAT(robot.surroundings.p_base_m, SizeIs(64));
  EXPECT_NEAR(robot.surroundings.p_base_m[0].z(), -1, 1e-6);
  EXPECT_TRUE(robot.knew_surroundings);
}

TEST_F(PickCycleTest, OneSlipOfTheGrippersSensorIsReadAgain) {
  script({planned()});
  robot.readings = {true, false, true, true};
  EXPECT_EQ(run().back(), "DONE");
  EXPECT_EQ(records[0].verdict, Verdict::kPlaced);
}

TEST_F(PickCycleTest, ASensorThatContradictsItselfTwiceIsAFault) {
  script({planned(), planned()});
  robot.readings = {true, false, false, true};
  EXPECT_EQ(run().back(), "STOPPED");
  EXPECT_THAT(reason, HasSubstr("check: the gripper says by turns"));
  EXPECT_EQ(robot.told_all.back(), "stop");
  EXPECT_EQ(records[0].verdict, Verdict::kFault);
}

TEST_F(PickCycleTest, APartThatSticksIsLetGoTwice) {
  script({planned()});
  robot.readings = {true, true, true, true, true, true, false, false};
  EXPECT_EQ(run().back(), "DONE");
  EXPECT_EQ(records[0].verdict, Verdict::kPlaced);
  EXPECT_EQ(std::ranges::count(robot.told_all, "open 0.044"), 3);
}

TEST_F(PickCycleTest, AGripperThatDoesNotLetGoIsAFault) {
  script({planned(), planned()});
  robot.readings = std::deque<bool>(8, true);
  EXPECT_EQ(run().back(), "STOPPED");
  EXPECT_THAT(reason, HasSubstr("release: the gripper was opened twice and still holds something"));
  EXPECT_EQ(robot.told_all.back(), "stop");
  EXPECT_EQ(records[0].verdict, Verdict::kFault);
}

class BrokenPort : public PickCycleTest, public testing::WithParamInterface<const char*> {};

TEST_P(BrokenPort, ThatThrowsStopsTheArmAndKeepsTheRecord) {
  script({planned(), planned()});
  robot.throws_at = GetParam();
  EXPECT_EQ(run().back(), "STOPPED");
  EXPECT_THAT(reason, HasSubstr(fmt::format("{}: the socket is gone", GetParam())));
  EXPECT_EQ(robot.told_all.back(), "stop");
  ASSERT_THAT(records, SizeIs(1));
  EXPECT_EQ(records[0].verdict, Verdict::kFault);
  EXPECT_EQ(records[0].message, reason);
}

INSTANTIATE_TEST_SUITE_P(Orders, BrokenPort,
                         testing::Values("pre_grasp", "approach", "close", "lift", "transfer",
                                         "place", "retreat"),
                         [](const auto& tested) { return std::string(tested.param); });

/// Scripts that are too short make the fakes throw.
TEST_F(PickCycleTest, APortThatThrowsBetweenPicksStopsTheCycleToo) {
  task.reactions.none_registered = Reaction::kAsk;
  script({nothing(Outcome::kNoneRegistered)});
  EXPECT_THAT(run(), ElementsAre("CLEAR_VIEW", "ACQUIRE", "PLAN", "ASK", "STOPPED"));
  EXPECT_THAT(reason, HasSubstr("ASK: nobody answers"));
  EXPECT_EQ(robot.told_all.back(), "stop");

  camera.script.emplace_back(fakes::frame_of(1000));
  EXPECT_THAT(run(), ElementsAre("CLEAR_VIEW", "ACQUIRE", "PLAN", "STOPPED"));
  EXPECT_THAT(reason, HasSubstr("PLAN: no script"));
  EXPECT_THAT(records.back().message, HasSubstr("no script"));

  script({nothing(Outcome::kBinNotFound)});
  clock.breaks = true;
  EXPECT_THAT(run(), ElementsAre("CLEAR_VIEW", "ACQUIRE", "PLAN", "PAUSE", "STOPPED"));
  EXPECT_THAT(reason, HasSubstr("PAUSE: the clock"));
}

TEST_F(PickCycleTest, EveryStepIsTimed) {
  script({planned()});
  run();
  std::vector<std::string> steps;
  std::chrono::nanoseconds sum{};
  for (const auto& [step, duration] : records[0].steps) {
    steps.emplace_back(name_of(step));
    sum += duration;
  }
  EXPECT_THAT(steps,
              ElementsAre("open", "pre_grasp", "approach", "close", "lift", "check", "transfer",
                          "check", "place", "release", "check", "retreat", "out_of_view"));
  const PickRecord& record = records[0];
  EXPECT_EQ(sum, record.pick + record.place + record.clear_view);
  EXPECT_EQ(record.end - record.start, record.acquire + record.plan + sum);
}

}  // namespace
}  // namespace graspd::agent
