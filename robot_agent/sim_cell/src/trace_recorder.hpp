#pragma once

#include <span>
#include <string>
#include <vector>

#include "graspd/sim_cell/pick_trace.hpp"
#include "part_bodies.hpp"

namespace graspd::sim_cell {

/// The hardest that anything withstood a body that does not give way.
struct Resistance {
  double share = 0;  ///< of what stops an arm
  std::string by, what;

  bool is_stalling() const { return share > 1; }
};

/// Writes down what happens to robot and parts between two frames.
class TraceRecorder {
 public:
  /// The parts must outlive it.
  explicit TraceRecorder(const PartBodies& parts);

  void closes() { trace_.has_closed = true; }
  /// After each step.
  Resistance record(std::span<const simulation::Contact> contacts, double step_s, bool is_gripping);
  /// The trace until now; the next one begins.
  PickTrace finish(std::vector<std::size_t> placed);

 private:
  void begin();
  Touch& touch(const BodyLabel& by, const BodyLabel& what);
  void note_lifted();

  const PartBodies& parts_;
  PickTrace trace_;
  std::vector<Eigen::Vector3d> start_m_;
};

}  // namespace graspd::sim_cell
