#pragma once

#include <gmock/gmock.h>

#include "pick_cycle_fakes.hpp"

/// Answers of a server, and a pick cycle in a scripted cell.
namespace graspd::agent {

inline Object object_at(std::uint32_t id, const Eigen::Vector3d& p_base_m) {
  Object object;
  object.id = id;
  object.part_id = id % 2 == 0 ? "elbow" : "tee";
  object.T_base_part.translation() = p_base_m;
  object.p_base_segment_centroid_m = p_base_m + Eigen::Vector3d(0, 0, 0.01);
  object.score = 0.9;
  object.visible_fraction = 0.7;
  object.grs.grs = 1.0 / id;
  return object;
}

inline Grasp grasp_of(const Object& object) {
  Grasp grasp;
  grasp.object_id = object.id;
  grasp.T_base_grasp = object.T_base_part;
  grasp.T_base_grasp.linear() = Eigen::Vector3d(1, -1, -1).asDiagonal();  // from above
  grasp.opening_width_m = 0.044;
  grasp.standoff_m = 0.08;
  grasp.retreat_m = 0.10;
  grasp.score = object.grs.grs;
  return grasp;
}

/// Objects 1, 2, 3 in a row, 10 cm apart, each with a grasp.
inline PlanAnswer planned(Outcome outcome = Outcome::kPlanned) {
  PlanAnswer answer;
  answer.outcome = outcome;
  for (const std::uint32_t id : {1u, 2u, 3u}) {
    answer.objects.push_back(object_at(id, {0.1 * id, 0, 0}));
    answer.grasps.push_back(grasp_of(answer.objects.back()));
  }
  answer.timings = {{"registration", 42}};
  return answer;
}

inline PlanAnswer nothing(Outcome outcome) {
  PlanAnswer answer;
  answer.outcome = outcome;
  answer.reason = "so it is";
  return answer;
}

inline Result<PlanAnswer> refusal(Code code) { return fail(code, "no plan today"); }

class PickCycleTest : public testing::Test {
 protected:
  PickCycleTest() {
    task.request.parts = {{"tee", 0}, {"elbow", 0}};
    task.T_base_place.translation() = Eigen::Vector3d(0, 0.5, 0.1);
    task.retry = {.max_failures_n = 3,
                  .pause = std::chrono::milliseconds(100),
                  .max_pause = std::chrono::milliseconds(300)};
  }

  /// As many frames as answers; frame k has the depth 1000 + k everywhere.
  void script(std::vector<Result<PlanAnswer>> answers) {
    for (auto& answer : answers) {
      camera.script.emplace_back(
          fakes::frame_of(static_cast<std::uint16_t>(1000 + camera.script.size())));
      planner.script.push_back(std::move(answer));
    }
  }

  PickCycle make_cycle() {
    return {{camera, planner, robot, robot, clock, &person}, task, observer};
  }

  /// Runs to the end. \returns the states, the first one included.
  std::vector<std::string> run() {
    PickCycle cycle = make_cycle();
    std::vector<std::string> states{std::string(name_of(cycle.state()))};
    while (!cycle.is_over() && states.size() < 200) {
      states.emplace_back(name_of(cycle.step()));
    }
    reason = cycle.reason();
    return states;
  }

  fakes::FakeClock clock;
  fakes::FakeCamera camera{clock};
  fakes::FakePlanner planner{clock};
  fakes::FakeRobot robot{clock};
  fakes::FakeOperator person;
  Task task;
  fakes::FakeObserver observer;
  const std::vector<PickRecord>& records = observer.records;
  std::string reason;
};

}  // namespace graspd::agent
