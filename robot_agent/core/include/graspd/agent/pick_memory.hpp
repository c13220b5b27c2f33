#pragma once

#include <optional>
#include <string_view>
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
  /// What failed is not in the next bin.
  void bin_emptied() { failed_spots_.clear(); }
  /// The arm could not take this grasp of the present plan: it is ranked down in the next one.
  void passed_over(const Grasp& grasp, std::string_view reason);
  /// A plan came: what was passed over in the one before is forgotten.
  void planned() { passed_over_.clear(); }

  /// Replaces the request's last plan and failed spots.
  void add_to(PlanRequest& request) const;

 private:
  bool is_near(const FailedSpot& spot, const Grasp& grasp) const;

  double radius_m_;
  std::optional<LastPlan> last_plan_;
  std::vector<FailedSpot> failed_spots_;  ///< oldest first
  std::vector<FailedSpot> passed_over_;   ///< best first
};

}  // namespace graspd::agent
