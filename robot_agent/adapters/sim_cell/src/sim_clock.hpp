#pragma once

#include "graspd/agent/ports.hpp"
#include "graspd/sim_cell/physics_cell.hpp"

namespace graspd::agent {

/// The cell's time, and the time that planning took.
class SimClock final : public Clock {
 public:
  explicit SimClock(sim_cell::PhysicsCell& cell) : cell_(cell) {}

  std::chrono::nanoseconds now() override {
    return planning_ + std::chrono::duration_cast<std::chrono::nanoseconds>(
                           std::chrono::duration<double>(cell_.time_s()));
  }
  void sleep_for(std::chrono::nanoseconds duration) override {
    cell_.wait(std::chrono::duration<double>(duration).count());
  }
  void add_planning(std::chrono::nanoseconds duration) { planning_ += duration; }

 private:
  sim_cell::PhysicsCell& cell_;
  std::chrono::nanoseconds planning_{};
};

/// A planner whose wall time passes in the simulated cell.
class TimedPlanner final : public Planner {
 public:
  TimedPlanner(Planner& planner, SimClock& clock) : planner_(planner), clock_(clock) {}

  PlanReply plan(const DepthFrame& frame, const PlanRequest& request) override {
    const auto start = std::chrono::steady_clock::now();
    PlanReply reply = planner_.plan(frame, request);
    clock_.add_planning(std::chrono::steady_clock::now() - start);
    return reply;
  }

 private:
  Planner& planner_;
  SimClock& clock_;
};

}  // namespace graspd::agent
