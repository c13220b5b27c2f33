#include "grasp_changes.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace graspd::recorded {
namespace {

// As far as this a grasp may move and turn, and still be the same one.
constexpr double kMostMoved_m = 0.02;
constexpr double kMostTurned_rad = M_PI / 6;
// Which of several is the same one: a radian is as far as this.
constexpr double kRadian_m = 0.05;

std::string part_of(const PlanAnswer& answer, const Grasp& grasp) {
  const auto object = std::ranges::find(answer.objects, grasp.object_id, &Object::id);
  return object == answer.objects.end() ? std::string() : object->part_id;
}

double moved_m(const Grasp& a, const Grasp& b) {
  return (a.T_base_grasp.translation() - b.T_base_grasp.translation()).norm();
}

double turned_rad(const Grasp& a, const Grasp& b) {
  const Eigen::Matrix3d turn = a.T_base_grasp.linear().transpose() * b.T_base_grasp.linear();
  return Eigen::AngleAxisd(turn).angle();
}

/// The new grasp that is this old one: the nearest that is near enough and not taken yet.
std::optional<std::size_t> find_again(const PlanAnswer& before, const Grasp& old_grasp,
                                      const PlanAnswer& now, const std::vector<bool>& taken) {
  std::optional<std::size_t> best;
  double best_m = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < now.grasps.size(); ++i) {
    const Grasp& grasp = now.grasps[i];
    if (taken[i] || part_of(now, grasp) != part_of(before, old_grasp)) continue;
    const double apart_m = moved_m(old_grasp, grasp);
    const double apart_rad = turned_rad(old_grasp, grasp);
    if (apart_m > kMostMoved_m || apart_rad > kMostTurned_rad) continue;
    const double distance_m = apart_m + kRadian_m * apart_rad;
    if (distance_m >= best_m) continue;
    best_m = distance_m;
    best = i;
  }
  return best;
}

bool is_same(const Grasp& a, const Grasp& b) {
  return a.T_base_grasp.matrix() == b.T_base_grasp.matrix() &&
         a.opening_width_m == b.opening_width_m && a.score == b.score && a.room_m == b.room_m &&
         a.pick_point == b.pick_point;
}

}  // namespace

std::vector<GraspChange> grasp_changes(const PlanAnswer& before, const PlanAnswer& now) {
  std::vector<GraspChange> changes;
  std::vector<GraspChange> gone;
  std::vector<bool> taken(now.grasps.size(), false);
  for (std::size_t i = 0; i < before.grasps.size(); ++i) {
    const Grasp& old_grasp = before.grasps[i];
    GraspChange change;
    change.old_rank = i + 1;
    change.part_id = part_of(before, old_grasp);
    change.pick_point = old_grasp.pick_point;
    change.old_score = old_grasp.score;
    const auto again = find_again(before, old_grasp, now, taken);
    if (!again) {
      gone.push_back(change);
      continue;
    }
    taken[*again] = true;
    const Grasp& grasp = now.grasps[*again];
    if (*again == i && is_same(old_grasp, grasp)) continue;
    change.new_rank = *again + 1;
    change.pick_point = grasp.pick_point;
    change.moved_m = moved_m(old_grasp, grasp);
    change.turned_rad = turned_rad(old_grasp, grasp);
    change.opened_m = grasp.opening_width_m - old_grasp.opening_width_m;
    change.new_score = grasp.score;
    changes.push_back(change);
  }
  for (std::size_t i = 0; i < now.grasps.size(); ++i) {
    if (taken[i]) continue;
    GraspChange change;
    change.new_rank = i + 1;
    change.part_id = part_of(now, now.grasps[i]);
    change.pick_point = now.grasps[i].pick_point;
    change.new_score = now.grasps[i].score;
    changes.push_back(change);
  }
  std::ranges::sort(changes, {}, &GraspChange::new_rank);
  changes.insert(changes.end(), gone.begin(), gone.end());
  return changes;
}

}  // namespace graspd::recorded
