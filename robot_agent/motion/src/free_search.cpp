#include "free_search.hpp"

#include <ompl/base/ScopedState.h>
#include <ompl/base/samplers/UniformValidStateSampler.h>
#include <ompl/base/spaces/RealVectorStateSpace.h>
#include <ompl/base/terminationconditions/IterationTerminationCondition.h>
#include <ompl/datastructures/NearestNeighborsLinear.h>
#include <ompl/geometric/SimpleSetup.h>
#include <ompl/geometric/planners/rrt/RRTConnect.h>
#include <ompl/util/Console.h>

#include <algorithm>

#include "graspd/motion/trajectory.hpp"

namespace graspd::motion {
namespace {

namespace ob = ompl::base;
namespace og = ompl::geometric;

constexpr double kLongestBranch_rad = 1.0;

/// OMPL's generators take their seeds one after the other from a global one, so that an answer
/// would depend on all questions before it. This one always starts from the same.
class SeededSampler final : public ob::RealVectorStateSampler {
 public:
  explicit SeededSampler(const ob::StateSpace* space) : RealVectorStateSampler(space) {
    rng_.setLocalSeed(1);
  }
};

agent::Joints to_joints(const ob::State* state, unsigned joints_n) {
  return Eigen::Map<const agent::Joints>(state->as<ob::RealVectorStateSpace::StateType>()->values,
                                         joints_n);
}

std::shared_ptr<ob::RealVectorStateSpace> joint_space(std::span<const JointLimits> limits) {
  const auto space =
      std::make_shared<ob::RealVectorStateSpace>(static_cast<unsigned>(limits.size()));
  ob::RealVectorBounds bounds(static_cast<unsigned>(limits.size()));
  for (std::size_t j = 0; j < limits.size(); ++j) {
    bounds.setLow(static_cast<unsigned>(j), limits[j].min_rad);
    bounds.setHigh(static_cast<unsigned>(j), limits[j].max_rad);
  }
  space->setBounds(bounds);
  space->setStateSamplerAllocator(
      [](const ob::StateSpace* of) { return std::make_shared<SeededSampler>(of); });
  return space;
}

/// From each corner straight to the furthest one that can be reached.
std::vector<agent::Joints> shortened(const std::vector<agent::Joints>& corners_rad,
                                     const FreeSearch& search) {
  const auto is_free_line = [&](const agent::Joints& from_rad, const agent::Joints& to_rad) {
    return std::ranges::all_of(joint_line(from_rad, to_rad, search.step_rad).q_rad, search.is_free);
  };
  std::vector<agent::Joints> kept_rad{corners_rad.front()};
  for (std::size_t at = 0; at + 1 < corners_rad.size();) {
    std::size_t next = corners_rad.size() - 1;
    while (next > at + 1 && !is_free_line(corners_rad[at], corners_rad[next])) --next;
    kept_rad.push_back(corners_rad[next]);
    at = next;
  }
  return kept_rad;
}

}  // namespace

std::optional<std::vector<agent::Joints>> find_free_way(const FreeSearch& search,
                                                        const agent::Joints& from_rad,
                                                        const agent::Joints& to_rad) {
  ompl::msg::setLogLevel(ompl::msg::LOG_NONE);
  const auto space = joint_space(search.limits);
  const unsigned joints_n = space->getDimension();
  og::SimpleSetup setup(space);
  setup.setStateValidityChecker([&](const ob::State* state) {
    return space->satisfiesBounds(state) && search.is_free(to_joints(state, joints_n));
  });
  setup.getSpaceInformation()->setStateValidityCheckingResolution(search.step_rad /
                                                                  space->getMaximumExtent());
  const auto planner = std::make_shared<og::RRTConnect>(setup.getSpaceInformation());
  planner->setRange(kLongestBranch_rad);
  // The default's tree draws random numbers of its own.
  planner->setNearestNeighbors<ompl::NearestNeighborsLinear>();
  setup.setPlanner(planner);

  ob::ScopedState<ob::RealVectorStateSpace> start(space);
  ob::ScopedState<ob::RealVectorStateSpace> goal(space);
  for (unsigned j = 0; j < joints_n; ++j) {
    start[j] = from_rad[j];
    goal[j] = to_rad[j];
  }
  setup.setStartAndGoalStates(start, goal);
  ob::IterationTerminationCondition tries(static_cast<unsigned>(search.max_tries_n));
  if (setup.solve(tries) != ob::PlannerStatus::EXACT_SOLUTION) return std::nullopt;

  std::vector<agent::Joints> corners_rad;
  for (const ob::State* state : setup.getSolutionPath().getStates()) {
    corners_rad.push_back(to_joints(state, joints_n));
  }
  return shortened(corners_rad, search);
}

}  // namespace graspd::motion
