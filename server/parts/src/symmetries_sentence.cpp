#include "symmetries_sentence.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

#include "mesh_geometry.hpp"

namespace graspd::parts {
namespace {

/// Without the digits that are rounding errors, and without −0.
std::string triple(const Eigen::Vector3d& v) {
  const Eigen::Vector3d rounded = (v * 1e3).array().round() / 1e3 + 0.0;
  return fmt::format("({:g}, {:g}, {:g})", rounded.x(), rounded.y(), rounded.z());
}

std::string line(const Eigen::Vector3d& axis, const Eigen::Vector3d& point_m) {
  const std::string through = triple(point_m * 1e3);
  return through == "(0, 0, 0)" ? triple(axis)
                                : fmt::format("{} through {} mm", triple(axis), through);
}

/// The point of a turn's axis that is nearest to the origin.
Eigen::Vector3d point_of_axis_m(const Eigen::Isometry3d& T) {
  const Eigen::Matrix3d moved = Eigen::Matrix3d::Identity() - T.linear();
  return moved.completeOrthogonalDecomposition().solve(T.translation());
}

struct Turn {
  double angle_deg;
  Eigen::Vector3d axis, point_m;
};

/// The least turn about each axis that has one.
std::vector<Turn> least_turns(const std::vector<Eigen::Isometry3d>& group) {
  std::vector<Turn> turns;
  for (const Eigen::Isometry3d& T : group) {
    const Eigen::AngleAxisd turn(T.linear());
    const Eigen::Vector3d axis = with_fixed_sign(turn.axis());
    const double angle_deg = turn.angle() * 180 / std::numbers::pi;
    const auto known = std::find_if(turns.begin(), turns.end(), [&](const Turn& other) {
      return (other.axis - axis).norm() < 1e-3;
    });
    if (known == turns.end()) {
      turns.push_back({angle_deg, axis, point_of_axis_m(T)});
    } else {
      known->angle_deg = std::min(known->angle_deg, angle_deg);
    }
  }
  return turns;
}

std::string discrete(const std::vector<Eigen::Isometry3d>& group) {
  std::map<std::string, std::vector<Turn>> by_angle;
  for (const Turn& turn : least_turns(group)) {
    by_angle[fmt::format("{:.4g}°", turn.angle_deg)].push_back(turn);
  }
  std::vector<std::string> texts;
  for (const auto& [angle, turns] : by_angle) {
    const Turn& first = turns.front();
    texts.push_back(turns.size() == 1 ? angle + " about " + line(first.axis, first.point_m)
                                      : fmt::format("{} about {} axes", angle, turns.size()));
  }
  return fmt::format("{}", fmt::join(texts, ", "));
}

std::string continuous(const std::vector<ContinuousSymmetry>& symmetries) {
  if (symmetries.size() > 1) return "any turn: a ball";
  return "about " + line(symmetries.front().axis, symmetries.front().point_m);
}

}  // namespace

std::string symmetries_sentence(const Symmetries& symmetries) {
  std::string sentence = fmt::format("symmetries_discrete: {}", symmetries.discrete.size());
  if (!symmetries.discrete.empty()) sentence += " (" + discrete(symmetries.discrete) + ")";
  sentence += fmt::format("; symmetries_continuous: {}", symmetries.continuous.size());
  if (!symmetries.continuous.empty()) sentence += " (" + continuous(symmetries.continuous) + ")";
  return sentence;
}

}  // namespace graspd::parts
