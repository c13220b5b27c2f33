#include "pick_cycle_fixture.hpp"

/// What the cell does where there is nothing to pick.
namespace graspd::agent {
namespace {

using namespace std::chrono_literals;
using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;
using testing::SizeIs;

/// The reaction to an outcome, for it to be set.
Reaction& reaction_to(Reactions& reactions, Outcome outcome) {
  switch (outcome) {
    case Outcome::kBinEmpty:
      return reactions.bin_empty;
    case Outcome::kBinNotFound:
      return reactions.bin_not_found;
    case Outcome::kNoneRegistered:
      return reactions.none_registered;
    case Outcome::kAllInCollision:
      return reactions.all_in_collision;
    default:
      return reactions.none_reachable;
  }
}

class ReactionsTest : public PickCycleTest, public testing::WithParamInterface<Outcome> {
 protected:
  ReactionsTest() {
    // The camera looks straight down from 1 m; the frames show a plane 5 mm to 1 mm above the
    // floor.
    task.request.T_base_camera.translation().z() = 1.005;
    task.request.T_base_camera.linear() = Eigen::Vector3d(1, -1, -1).asDiagonal();
    task.request.bin = Bin{Eigen::Isometry3d::Identity(), {0.4, 0.3, 0.15}, 0.003};
  }
  void set(Reaction reaction) { reaction_to(task.reactions, GetParam()) = reaction; }

  /// An outcome of the agent comes with grasps, all out of reach.
  Result<PlanAnswer> no_grasp() {
    if (GetParam() != Outcome::kNoneReachable) return nothing(GetParam());
    PlanAnswer answer = planned();
    for (Grasp& grasp : answer.grasps) grasp.T_base_grasp.translation().x() += 100;
    return answer;
  }
};

TEST_P(ReactionsTest, StopEndsAtOnceAndSaysWhy) {
  set(Reaction::kStop);
  script({no_grasp(), planned()});
  const bool is_empty = GetParam() == Outcome::kBinEmpty;
  EXPECT_THAT(run(), ElementsAre("CLEAR_VIEW", "ACQUIRE", "PLAN", is_empty ? "DONE" : "STOPPED"));
  EXPECT_THAT(reason, HasSubstr(std::string(name_of(GetParam()))));
  ASSERT_THAT(records, SizeIs(1));
  EXPECT_EQ(records[0].reaction, Reaction::kStop);
  EXPECT_THAT(clock.sleeps, IsEmpty());
}

TEST_P(ReactionsTest, WaitLooksAgainAfterAPause) {
  set(Reaction::kWait);
  script({no_grasp(), planned()});
  EXPECT_THAT(run(), ElementsAre("CLEAR_VIEW", "ACQUIRE", "PLAN", "PAUSE", "ACQUIRE", "PLAN",
                                 "PICK", "PLACE", "CLEAR_VIEW", "ACQUIRE", "DONE"));
  EXPECT_THAT(clock.sleeps, SizeIs(1));
  EXPECT_EQ(records[0].reaction, Reaction::kWait);
}

TEST_P(ReactionsTest, AskGoesOnOrStopsAsTheOperatorSays) {
  set(Reaction::kAsk);
  person.script = {OperatorSays::kGoOn, OperatorSays::kStop};
  script({no_grasp(), no_grasp(), planned()});
  EXPECT_THAT(
      run(), ElementsAre("CLEAR_VIEW", "ACQUIRE", "PLAN", "ASK", "ACQUIRE", "PLAN", "ASK", "DONE"));
  ASSERT_THAT(person.asked, SizeIs(2));
  EXPECT_THAT(person.asked[0], HasSubstr(std::string(name_of(GetParam()))));
  EXPECT_EQ(reason, "the operator said stop: " + person.asked[1]);
  EXPECT_THAT(records, SizeIs(2));
  EXPECT_EQ(records[1].reaction, Reaction::kAsk);
}

TEST_P(ReactionsTest, StirTakesTheClosedGripperThroughThePileAndLooksAgain) {
  set(Reaction::kStir);
  robot.holds = {false};
  script({no_grasp(), planned()});
  EXPECT_THAT(run(), ElementsAre("CLEAR_VIEW", "ACQUIRE", "PLAN", "STIR", "CLEAR_VIEW", "ACQUIRE",
                                 "PLAN", "PICK", "PLACE", "CLEAR_VIEW", "ACQUIRE", "DONE"))
      << reason;
  const std::vector<std::string> first(robot.told_all.begin(), robot.told_all.begin() + 8);
  EXPECT_THAT(first, ElementsAre("out_of_view", "close", "stir_above", "stir_down", "stir_across",
                                 "stir_up", "holds?", "out_of_view"));
  EXPECT_EQ(records[0].stir, 600ms);
  EXPECT_EQ(records[0].clear_view, 100ms);
  EXPECT_THAT(clock.sleeps, IsEmpty());
}

TEST_P(ReactionsTest, APartThatAStirCaughtGoesBackIntoTheBin) {
  set(Reaction::kStir);
  task.request.gripper.max_opening_m = 0.07;
  robot.holds = {true, true};  // after the stir, then the part that is picked
  script({no_grasp(), planned()});
  EXPECT_EQ(run().back(), "DONE") << reason;
  const std::vector<std::string> last(robot.told_all.begin() + 5, robot.told_all.begin() + 10);
  EXPECT_THAT(last, ElementsAre("stir_up", "holds?", "open 0.070", "holds?", "out_of_view"));
}

TEST_P(ReactionsTest, APartThatAStirCaughtAndThatSticksStopsTheCell) {
  set(Reaction::kStir);
  robot.readings = std::deque<bool>(6, true);
  script({no_grasp(), planned()});
  EXPECT_EQ(run().back(), "STOPPED");
  EXPECT_THAT(reason, HasSubstr("opened twice and still holds something"));
}

TEST_P(ReactionsTest, StirIsBoundedAndThenStops) {
  set(Reaction::kStir);
  task.stir.max_in_a_row_n = 2;
  script({no_grasp(), no_grasp(), no_grasp(), planned()});
  EXPECT_EQ(run().back(), "STOPPED");
  EXPECT_THAT(reason, HasSubstr("stirred 2 times in a row, and still"));
  EXPECT_THAT(records, SizeIs(3));
  EXPECT_EQ(records[2].reaction, Reaction::kStop);
}

TEST_P(ReactionsTest, APlacedPartAllowsFurtherStirs) {
  set(Reaction::kStir);
  task.stir.max_in_a_row_n = 1;
  script({no_grasp(), planned(), no_grasp(), planned()});
  EXPECT_EQ(run().back(), "DONE");
}

TEST_P(ReactionsTest, WhereTheArmCanNotStirItWaitsAndSaysSo) {
  set(Reaction::kStir);
  robot.cannot = "stir_down";
  script({no_grasp(), planned()});
  const auto states = run();
  EXPECT_THAT(states, Contains("PAUSE"));
  EXPECT_THAT(records[0].message, HasSubstr("can't stir: stir_down is out of reach"));
  EXPECT_THAT(robot.told_all, Not(Contains("stir_above")));
  EXPECT_EQ(states.back(), "DONE");
}

TEST_P(ReactionsTest, AFaultWhileStirringStopsTheArm) {
  set(Reaction::kStir);
  robot.fails_at = "stir_across";
  script({no_grasp(), planned()});
  EXPECT_EQ(run().back(), "STOPPED");
  EXPECT_EQ(robot.told_all.back(), "stop");
  EXPECT_THAT(reason, HasSubstr("stir_across: the stir_across motor is hot"));
  EXPECT_EQ(records.at(0).message, reason);
}

INSTANTIATE_TEST_SUITE_P(Outcomes, ReactionsTest,
                         testing::Values(Outcome::kNoneRegistered, Outcome::kAllInCollision,
                                         Outcome::kBinNotFound, Outcome::kNoneReachable,
                                         Outcome::kBinEmpty),
                         [](const auto& tested) { return std::string(name_of(tested.param)); });

TEST_F(PickCycleTest, WaitsForTheNextBinForAsLongAsItTakes) {
  task.reactions.bin_empty = Reaction::kWait;
  std::vector<Result<PlanAnswer>> answers(20, nothing(Outcome::kBinEmpty));
  answers.emplace_back(planned());
  script(std::move(answers));
  EXPECT_EQ(run().back(), "DONE");
  EXPECT_THAT(clock.sleeps, SizeIs(20));
  EXPECT_THAT(clock.sleeps, testing::Each(300ms));
  EXPECT_EQ(records.back().verdict, Verdict::kPlaced);
}

TEST_F(PickCycleTest, AnOperatorWhoGoesOnStartsTheCountOfFailuresAnew) {
  task.reactions.bin_not_found = Reaction::kAsk;
  person.script = {OperatorSays::kGoOn};
  const auto none = nothing(Outcome::kNoneRegistered);
  script({none, none, none, nothing(Outcome::kBinNotFound), none, none, none});
  EXPECT_EQ(run().back(), "DONE");
}

TEST_F(PickCycleTest, AReactionThatNeedsWhatIsNotThereIsAMistake) {
  task.reactions.all_in_collision = Reaction::kStir;
  EXPECT_THROW(make_cycle(), std::invalid_argument) << "no bin";
  task.reactions.all_in_collision = Reaction::kAsk;
  EXPECT_NO_THROW(make_cycle());
  EXPECT_THROW(PickCycle({camera, planner, robot, robot, clock}, task, observer),
               std::invalid_argument)
      << "no operator";
}

}  // namespace
}  // namespace graspd::agent
