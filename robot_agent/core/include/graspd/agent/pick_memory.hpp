#pragma once

#include <optional>
#include <vector>

#include "graspd/types/answer.hpp"
#include "graspd/types/request.hpp"

namespace graspd::agent {

/// What must survive from one pick to the next. The server keeps nothing: all of this travels in
/// the next request.
class PickMemory {
 public:
  explicit PickMemory(double failed_spot_radius_m) : radius_m_(failed_spot_radius_m) {}

  /// The part was taken away: the other objects should still stand, and what had failed at this
  /// spot is gone. Where there are more than a request may carry, all are registered anew.
  void placed(const PlanAnswer& answer, const Grasp& grasp);
  /// The grasp failed, and may have moved things: the next frame is registered anew.
  void failed(const Grasp& grasp);
  /// Nothing could be grasped: registered anew, another frame may show more.
  void nothing_grasped() { last_plan_.reset(); }

  void add_to(PlanRequest& request) const;

 private:
  bool is_near(const FailedSpot& spot, const Grasp& grasp) const;

  double radius_m_;
  std::optional<LastPlan> last_plan_;
  std::vector<FailedSpot> failed_spots_;  ///< oldest first
};

}  // namespace graspd::agent
