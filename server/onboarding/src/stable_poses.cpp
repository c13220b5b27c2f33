#include "graspd/onboarding/stable_poses.hpp"

#include <LinearMath/btConvexHullComputer.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>

namespace graspd::onboarding {
namespace {

/// Triangles of the hull whose normals differ by less are one face: meshes are round to a few
/// digits.
constexpr double kSameFaceCosine = 0.99999;  // 0.26°
/// A symmetry turns one pose into another where it takes its direction to within this.
constexpr double kSamePoseCosine = 0.9995;  // 1.8°

/// Of all ways to set it down: nobody will see the part stand on its very tip.
constexpr double kNever = 1e-6;

struct HullTriangle {
  std::array<Eigen::Vector3d, 3> corners_m;  ///< from the barycentre
  std::array<int, 3> vertices;
  Eigen::Vector3d normal;  ///< unit, outwards
};

struct Face {
  Eigen::Vector3d normal = Eigen::Vector3d::Zero();
  double height_m = 0;
  double solid_angle = 0;
  /// To the nearest edge's foot, negative beyond it, and what lies beyond that edge.
  double margin_m = std::numeric_limits<double>::infinity();
  std::size_t beyond = 0;
};

/// Van Oosterom and Strackee 1983.
double solid_angle(const std::array<Eigen::Vector3d, 3>& p) {
  const double a = p[0].norm(), b = p[1].norm(), c = p[2].norm();
  const double denominator =
      a * b * c + p[0].dot(p[1]) * c + p[0].dot(p[2]) * b + p[1].dot(p[2]) * a;
  return 2 * std::atan2(std::abs(p[0].dot(p[1].cross(p[2]))), denominator);
}

std::vector<HullTriangle> hull_of(const parts::Part& part) {
  std::vector<Eigen::Vector3d> points_m;
  for (const auto& vertex : part.mesh.vertices_m) {
    points_m.push_back(vertex.cast<double>() - part.barycentre_m);
  }
  btConvexHullComputer computer;
  computer.compute(points_m.front().data(), sizeof(Eigen::Vector3d),
                   static_cast<int>(points_m.size()), 0, 0);
  const auto corner = [&](int i) -> Eigen::Vector3d {
    const auto& v = computer.vertices[i];
    return {static_cast<double>(v.x()), static_cast<double>(v.y()), static_cast<double>(v.z())};
  };
  std::vector<HullTriangle> triangles;
  for (int f = 0; f < computer.faces.size(); ++f) {
    const auto* first = &computer.edges[computer.faces[f]];
    for (auto* edge = first->getNextEdgeOfFace();
         edge->getTargetVertex() != first->getSourceVertex(); edge = edge->getNextEdgeOfFace()) {
      const std::array vertices{first->getSourceVertex(), edge->getSourceVertex(),
                                edge->getTargetVertex()};
      HullTriangle triangle{{corner(vertices[0]), corner(vertices[1]), corner(vertices[2])},
                            vertices,
                            Eigen::Vector3d::Zero()};
      const auto& p = triangle.corners_m;
      Eigen::Vector3d normal = (p[1] - p[0]).cross(p[2] - p[0]);
      if (!(normal.norm() > 1e-16)) continue;  // m²: a sliver of no direction
      // The barycentre is inside the hull of its own solid.
      triangle.normal = (normal.dot(p[0]) < 0 ? -normal : normal).normalized();
      triangles.push_back(triangle);
    }
  }
  return triangles;
}

std::pair<int, int> edge_of(const HullTriangle& triangle, std::size_t k) {
  return std::minmax({triangle.vertices[k], triangle.vertices[(k + 1) % 3]});
}

class Hull {
 public:
  explicit Hull(const parts::Part& part) : triangles_(hull_of(part)) {
    for (std::size_t i = 0; i < triangles_.size(); ++i) {
      for (std::size_t k = 0; k < 3; ++k) sides_[edge_of(triangles_[i], k)].push_back(i);
    }
    merge_coplanar();
    for (std::size_t i = 0; i < triangles_.size(); ++i) measure_edges(i);
  }

  const std::vector<Face>& faces() const { return faces_; }

  /// Where a part set down on this face comes to rest: over the nearest edge, again and again. Each
  /// tip lowers the barycentre, so that this ends.
  std::size_t rest_of(std::size_t face) const {
    while (faces_[face].margin_m < 0 &&
           faces_[faces_[face].beyond].height_m < faces_[face].height_m) {
      face = faces_[face].beyond;
    }
    return face;
  }

 private:
  /// Numbers the faces by flooding over edges between triangles of one plane.
  void merge_coplanar() {
    face_of_.assign(triangles_.size(), kNone);
    for (std::size_t i = 0; i < triangles_.size(); ++i) {
      if (face_of_[i] != kNone) continue;
      faces_.emplace_back();
      std::vector<std::size_t> open{i};
      face_of_[i] = faces_.size() - 1;
      while (!open.empty()) {
        const std::size_t at = open.back();
        open.pop_back();
        take_into_face(at, faces_.back());
        for (const std::size_t next : neighbours_of(at)) {
          // To the first one, so that a round surface is not all one face.
          if (face_of_[next] != kNone ||
              triangles_[next].normal.dot(triangles_[i].normal) < kSameFaceCosine) {
            continue;
          }
          face_of_[next] = face_of_[i];
          open.push_back(next);
        }
      }
      faces_.back().normal.normalize();
      faces_.back().height_m = faces_.back().normal.dot(triangles_[i].corners_m[0]);
    }
  }

  void take_into_face(std::size_t i, Face& face) const {
    const auto& p = triangles_[i].corners_m;
    face.normal += (p[1] - p[0]).cross(p[2] - p[0]).norm() * triangles_[i].normal;
    face.solid_angle += solid_angle(p);
  }

  std::vector<std::size_t> neighbours_of(std::size_t i) const {
    std::vector<std::size_t> neighbours;
    for (std::size_t k = 0; k < 3; ++k) {
      for (const std::size_t other : sides_.at(edge_of(triangles_[i], k))) {
        if (other != i) neighbours.push_back(other);
      }
    }
    return neighbours;
  }

  /// How far inside its face's edges the barycentre's foot is.
  void measure_edges(std::size_t i) {
    Face& face = faces_[face_of_[i]];
    const auto& p = triangles_[i].corners_m;
    const Eigen::Vector3d middle_m = (p[0] + p[1] + p[2]) / 3;
    for (std::size_t k = 0; k < 3; ++k) {
      for (const std::size_t other : sides_.at(edge_of(triangles_[i], k))) {
        if (face_of_[other] == face_of_[i]) continue;
        const Eigen::Vector3d along = (p[(k + 1) % 3] - p[k]).normalized();
        Eigen::Vector3d inwards = face.normal.cross(along);
        if (inwards.dot(middle_m - p[k]) < 0) inwards = -inwards;
        const Eigen::Vector3d foot_m = face.height_m * face.normal;
        const double margin_m = inwards.dot(foot_m - p[k]);
        if (margin_m < face.margin_m) {
          face.margin_m = margin_m;
          face.beyond = face_of_[other];
        }
      }
    }
  }

  static constexpr std::size_t kNone = std::numeric_limits<std::size_t>::max();

  std::vector<HullTriangle> triangles_;
  std::map<std::pair<int, int>, std::vector<std::size_t>> sides_;
  std::vector<std::size_t> face_of_;
  std::vector<Face> faces_;
};

/// Whether a turn about a continuous axis takes one direction to the other.
bool turns_into(const Eigen::Vector3d& a, const Eigen::Vector3d& b,
                const std::vector<parts::ContinuousSymmetry>& axes) {
  if (axes.size() > 1) return true;  // a ball
  if (axes.empty()) return a.dot(b) > kSamePoseCosine;
  const Eigen::Vector3d axis = axes.front().axis.normalized();
  const double along_a = std::acos(std::clamp(axis.dot(a), -1.0, 1.0));
  const double along_b = std::acos(std::clamp(axis.dot(b), -1.0, 1.0));
  return std::cos(along_a - along_b) > kSamePoseCosine;
}

/// Poses that differ by a turn about a continuous axis, as one.
std::vector<StablePose> joined(const std::vector<StablePose>& poses,
                               const std::vector<parts::ContinuousSymmetry>& axes) {
  std::vector<StablePose> result;
  for (const StablePose& pose : poses) {
    const auto same = std::ranges::find_if(
        result, [&](const StablePose& other) { return turns_into(pose.down, other.down, axes); });
    if (same == result.end()) {
      result.push_back(pose);
    } else {
      same->probability += pose.probability;
    }
  }
  return result;
}

}  // namespace

std::vector<StablePose> stable_poses(const parts::Part& part) {
  const Hull hull(part);
  const std::vector<Face>& faces = hull.faces();
  std::vector<double> shares(faces.size());
  for (std::size_t i = 0; i < faces.size(); ++i) shares[hull.rest_of(i)] += faces[i].solid_angle;
  const double whole = std::accumulate(shares.begin(), shares.end(), 0.0);
  std::vector<StablePose> poses;
  for (std::size_t i = 0; i < faces.size(); ++i) {
    if (shares[i] <= kNever * whole) continue;
    poses.push_back({faces[i].normal, faces[i].height_m, shares[i] / whole,
                     std::atan2(std::max(0.0, faces[i].margin_m), faces[i].height_m)});
  }
  if (!part.symmetries.continuous.empty()) poses = joined(poses, part.symmetries.continuous);
  std::ranges::stable_sort(poses, std::greater<>(), &StablePose::probability);
  return poses;
}

std::vector<std::vector<std::size_t>> alike(const std::vector<StablePose>& poses,
                                            const parts::Part& part) {
  std::vector<Eigen::Matrix3d> turns{Eigen::Matrix3d::Identity()};
  for (const auto& T : part.symmetries.discrete) turns.push_back(T.linear());
  std::vector<std::vector<std::size_t>> groups;
  for (std::size_t i = 0; i < poses.size(); ++i) {
    const auto is_alike = [&](const std::vector<std::size_t>& group) {
      return std::ranges::any_of(turns, [&](const Eigen::Matrix3d& R) {
        return turns_into(R * poses[i].down, poses[group.front()].down, part.symmetries.continuous);
      });
    };
    const auto group = std::ranges::find_if(groups, is_alike);
    if (group == groups.end()) {
      groups.push_back({i});
    } else {
      group->push_back(i);
    }
  }
  const auto probability = [&](const std::vector<std::size_t>& group) {
    double sum = 0;
    for (const std::size_t i : group) sum += poses[i].probability;
    return sum;
  };
  std::ranges::stable_sort(groups, std::greater<>(), probability);
  return groups;
}

}  // namespace graspd::onboarding
