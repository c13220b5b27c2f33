#include "pick_cycle_fixture.hpp"

namespace graspd::agent {
namespace {

using namespace std::chrono_literals;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;

TEST_F(PickCycleTest, AMissedGraspIsAFailedSpotAndIsRegisteredAnew) {
  script({planned(), planned(), planned()});
  robot.holds = {false, false};
  EXPECT_THAT(run(), ElementsAre("CLEAR_VIEW", "ACQUIRE", "PLAN", "PICK", "CLEAR_VIEW", "ACQUIRE",
                                 "PLAN", "PICK", "CLEAR_VIEW", "ACQUIRE", "PLAN", "PICK", "PLACE",
                                 "CLEAR_VIEW", "ACQUIRE", "DONE"));
  EXPECT_EQ(records[0].verdict, Verdict::kMissed);
  EXPECT_EQ(records[0].message, "the gripper is empty after lifting");
  ASSERT_THAT(planner.requests[1].failed_spots, SizeIs(1));
  EXPECT_FALSE(planner.requests[1].last_plan);
  EXPECT_TRUE(planner.requests[1].failed_spots[0].p_base_m.isApprox(Eigen::Vector3d(0.1, 0, 0)));
  EXPECT_EQ(planner.requests[1].failed_spots[0].radius_m, task.failed_spot_radius_m);
  EXPECT_EQ(planner.requests[1].failed_spots[0].failures_n, 1u);
  // The same spot again counts up; it does not become a second one.
  ASSERT_THAT(planner.requests[2].failed_spots, SizeIs(1));
  EXPECT_EQ(planner.requests[2].failed_spots[0].failures_n, 2u);
}

TEST_F(PickCycleTest, APartThatIsTakenAwayClearsItsFailedSpot) {
  script({planned(), planned(), planned()});
  robot.holds = {false};  // missed, then placed from the same spot
  run();
  EXPECT_THAT(planner.requests[1].failed_spots, SizeIs(1));
  EXPECT_THAT(planner.requests[2].failed_spots, IsEmpty());
}

TEST_F(PickCycleTest, AFailedSpotElsewhereIsKept) {
  PlanAnswer elsewhere = planned();
  elsewhere.grasps.erase(elsewhere.grasps.begin());
  script({planned(), elsewhere, planned()});
  robot.holds = {false};
  run();
  EXPECT_THAT(planner.requests[2].failed_spots, SizeIs(1));
}

TEST_F(PickCycleTest, ADroppedPartIsAFailedSpotToo) {
  script({planned(), planned()});
  robot.holds = {true, false};
  EXPECT_THAT(run(),
              ElementsAre("CLEAR_VIEW", "ACQUIRE", "PLAN", "PICK", "PLACE", "CLEAR_VIEW", "ACQUIRE",
                          "PLAN", "PICK", "PLACE", "CLEAR_VIEW", "ACQUIRE", "DONE"));
  EXPECT_EQ(records[0].verdict, Verdict::kDropped);
  EXPECT_THAT(planner.requests[1].failed_spots, SizeIs(1));
  EXPECT_FALSE(planner.requests[1].last_plan);
}

TEST_F(PickCycleTest, GivesUpAfterTooManyMissesInARow) {
  script({planned(), planned(), planned(), planned(), planned()});
  robot.holds = {false, false, false, false, false};
  EXPECT_EQ(run().back(), "STOPPED");
  EXPECT_EQ(reason, "4 failures in a row, the last: MISSED: the gripper is empty after lifting");
  EXPECT_THAT(records, SizeIs(4));
  EXPECT_EQ(robot.told_all.back(), "out_of_view");
}

TEST_F(PickCycleTest, NothingWithinReachIsSaidAndTriedAgain) {
  script({planned(), planned()});
  robot.reach_m = 0.05;
  EXPECT_THAT(run(), ElementsAre("CLEAR_VIEW", "ACQUIRE", "PLAN", "PAUSE", "ACQUIRE", "PLAN",
                                 "PAUSE", "ACQUIRE", "DONE"));
  EXPECT_EQ(records[0].outcome, Outcome::kNoneReachable);
  EXPECT_THAT(records[0].message, HasSubstr("none of 3 grasps"));
  EXPECT_FALSE(records[0].chosen);
  EXPECT_THAT(robot.motions, IsEmpty());
}

class NothingToPick : public PickCycleTest, public testing::WithParamInterface<Outcome> {};

TEST_P(NothingToPick, IsTriedAgainWithFreshFramesAndLongerPausesAndThenGivenUp) {
  script({planned(), nothing(GetParam()), nothing(GetParam()), nothing(GetParam()),
          nothing(GetParam()), planned()});
  const auto states = run();
  EXPECT_EQ(states.back(), "STOPPED");
  EXPECT_THAT(clock.sleeps, ElementsAre(100ms, 200ms, 300ms));
  EXPECT_EQ(reason,
            fmt::format("4 failures in a row, the last: {}: so it is", name_of(GetParam())));
  EXPECT_THAT(planner.frames, SizeIs(5));
  EXPECT_EQ(planner.frames[4].at(0, 0), 1004);
  EXPECT_THAT(records, SizeIs(5));
  // After a plan without a pick, the next frame is registered anew.
  EXPECT_TRUE(planner.requests[1].last_plan);
  EXPECT_FALSE(planner.requests[2].last_plan);
}

TEST_P(NothingToPick, IsForgottenAfterTheNextPick) {
  script({nothing(GetParam()), nothing(GetParam()), nothing(GetParam()), planned(),
          nothing(GetParam()), nothing(GetParam()), nothing(GetParam())});
  EXPECT_EQ(run().back(), "DONE");
  EXPECT_THAT(clock.sleeps, ElementsAre(100ms, 200ms, 300ms, 100ms, 200ms, 300ms));
}

INSTANTIATE_TEST_SUITE_P(Outcomes, NothingToPick,
                         testing::Values(Outcome::kNoneRegistered, Outcome::kAllInCollision,
                                         Outcome::kBinNotFound, Outcome::kNoneReachable),
                         [](const auto& tested) { return std::string(name_of(tested.param)); });

class NoAnswer : public PickCycleTest, public testing::WithParamInterface<Code> {};

TEST_P(NoAnswer, IsTriedAgainAndThenGivenUp) {
  script({refusal(GetParam()), refusal(GetParam()), refusal(GetParam()), refusal(GetParam())});
  EXPECT_EQ(run().back(), "STOPPED");
  EXPECT_THAT(clock.sleeps, ElementsAre(100ms, 200ms, 300ms));
  EXPECT_THAT(reason, HasSubstr(fmt::format("{}: no plan today", name_of(GetParam()))));
  ASSERT_THAT(records, SizeIs(4));
  EXPECT_EQ(records[0].code, GetParam());
  EXPECT_EQ(records[0].request_id, "0123");
  EXPECT_FALSE(records[0].outcome);
  EXPECT_THAT(robot.motions, IsEmpty());
}

TEST_P(NoAnswer, ToTheLastFrameIsNoGoodEnd) {
  script({planned(), refusal(GetParam())});
  EXPECT_EQ(run().back(), "STOPPED");
  EXPECT_EQ(reason, fmt::format("no more frames after 2, the last without an answer: "
                                "{}: no plan today",
                                name_of(GetParam())));
}

TEST_P(NoAnswer, KeepsTheLastPlanAndIsForgottenWithTheNextAnswer) {
  script({planned(), refusal(GetParam()), planned()});
  EXPECT_EQ(run().back(), "DONE");
  EXPECT_TRUE(planner.requests[2].last_plan);
}

INSTANTIATE_TEST_SUITE_P(Codes, NoAnswer,
                         testing::Values(Code::kBusy, Code::kSuperseded, Code::kDeadlineExceeded,
                                         Code::kDraining, Code::kRejectedPoison, Code::kInternal,
                                         Code::kUnavailable),
                         [](const auto& tested) { return std::string(name_of(tested.param)); });

class Refused : public PickCycleTest, public testing::WithParamInterface<Code> {};

TEST_P(Refused, StopsAtOnce) {
  script({refusal(GetParam()), planned()});
  EXPECT_THAT(run(), ElementsAre("CLEAR_VIEW", "ACQUIRE", "PLAN", "STOPPED"));
  EXPECT_EQ(reason, fmt::format("{}: no plan today", name_of(GetParam())));
  EXPECT_THAT(clock.sleeps, IsEmpty());
  ASSERT_THAT(records, SizeIs(1));
  EXPECT_EQ(records[0].code, GetParam());
}

INSTANTIATE_TEST_SUITE_P(Codes, Refused,
                         testing::Values(Code::kInvalidArgument, Code::kUnsupportedVersion,
                                         Code::kUnauthenticated, Code::kUnknownPart),
                         [](const auto& tested) { return std::string(name_of(tested.param)); });

class RobotFault : public PickCycleTest, public testing::WithParamInterface<const char*> {};

TEST_P(RobotFault, StopsTheArmAndTellsItNothingMore) {
  script({planned(), planned()});
  robot.fails_at = GetParam();
  EXPECT_EQ(run().back(), "STOPPED");
  EXPECT_THAT(reason, HasSubstr(fmt::format("the {} motor is hot", GetParam())));
  ASSERT_THAT(robot.told_all, SizeIs(testing::Ge(2u)));
  EXPECT_EQ(robot.told_all.back(), "stop");
  EXPECT_EQ(robot.told_all[robot.told_all.size() - 2], GetParam());
  if (std::string(GetParam()) == "out_of_view") return;  // before the first frame
  ASSERT_THAT(records, SizeIs(1));
  EXPECT_EQ(records[0].verdict, Verdict::kFault);
  EXPECT_EQ(records[0].message, reason);
}

INSTANTIATE_TEST_SUITE_P(Orders, RobotFault,
                         testing::Values("out_of_view", "pre_grasp", "open 0.044", "approach",
                                         "close", "lift", "holds?", "transfer", "place", "retreat"),
                         [](const auto& tested) {
                           std::string name = tested.param;
                           std::erase_if(name, [](unsigned char c) { return !std::isalnum(c); });
                           return name;
                         });

TEST_F(PickCycleTest, AFaultAfterPlacingLeavesThePartPlaced) {
  script({planned()});
  PickCycle cycle = make_cycle();
  while (cycle.state() != State::kPlace) cycle.step();
  robot.fails_at = "out_of_view";
  while (!cycle.is_over()) cycle.step();
  EXPECT_EQ(cycle.state(), State::kStopped);
  ASSERT_THAT(records, SizeIs(1));
  EXPECT_EQ(records[0].verdict, Verdict::kPlaced);
  EXPECT_THAT(records[0].message, HasSubstr("the out_of_view motor is hot"));
}

TEST_F(PickCycleTest, ACameraThatFailsStopsTheCycle) {
  script({planned()});
  camera.script.push_back(invalid("recording.rawlog: broken after 1 frames"));
  EXPECT_EQ(run().back(), "STOPPED");
  EXPECT_EQ(reason, "camera: recording.rawlog: broken after 1 frames");
  EXPECT_EQ(robot.told_all.back(), "stop");
  EXPECT_THAT(records, SizeIs(1));
}

TEST_F(PickCycleTest, AnArmThatCannotBeStoppedIsSaid) {
  script({planned()});
  camera.script.push_back(invalid("the camera is gone"));
  robot.can_be_stopped = false;
  EXPECT_EQ(run().back(), "STOPPED");
  EXPECT_THAT(reason,
              testing::AllOf(testing::StartsWith("camera: the camera is gone"),
                             HasSubstr("no answer for 1 s"), HasSubstr("use the emergency stop")));
}

TEST_F(PickCycleTest, AFrameThatSaysNothingIsNotSentAndTriedAgain) {
  camera.script.emplace_back(fakes::frame_of(0));
  script({planned()});
  EXPECT_THAT(run(), ElementsAre("CLEAR_VIEW", "ACQUIRE", "PAUSE", "ACQUIRE", "PLAN", "PICK",
                                 "PLACE", "CLEAR_VIEW", "ACQUIRE", "DONE"));
  EXPECT_THAT(planner.frames, SizeIs(1));
  EXPECT_THAT(observer.planned_frames, ElementsAre(1));
  EXPECT_EQ(records[0].code, Code::kInvalidArgument);
  EXPECT_THAT(records[0].message, HasSubstr("all 64 pixels are 0"));
}

TEST_F(PickCycleTest, SteppingOnAfterTheEndIsAMistake) {
  PickCycle cycle = make_cycle();
  while (!cycle.is_over()) cycle.step();
  EXPECT_THROW(cycle.step(), std::logic_error);
}

TEST(PickMemoryTest, ForgetsTheOldestFailedSpotsFirst) {
  PickMemory memory(0.001);
  for (std::uint32_t i = 0; i <= kMaxFailedSpots; ++i) {
    memory.failed(grasp_of(object_at(1, {0.01 * i, 0, 0})));
  }
  PlanRequest request;
  memory.add_to(request);
  ASSERT_EQ(request.failed_spots.size(), kMaxFailedSpots);
  EXPECT_NEAR(request.failed_spots.front().p_base_m.x(), 0.01, 1e-12);
}

}  // namespace
}  // namespace graspd::agent
