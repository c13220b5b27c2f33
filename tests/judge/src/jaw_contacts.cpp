#include "jaw_contacts.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace graspd::judge {
namespace {

constexpr double kCell_m = 0.0005;
constexpr double kTouch_m = 0.0005;

}  // namespace

JawContacts::JawContacts(const Gripper& gripper, double opening_width_m)
    : between_m_(Eigen::Vector3d(-opening_width_m / 2, -gripper.jaw_size_m.y() / 2,
                                 -gripper.jaw_size_m.z()),
                 Eigen::Vector3d(opening_width_m / 2, gripper.jaw_size_m.y() / 2, 0)),
      columns_n_(std::max(1, static_cast<int>(gripper.jaw_size_m.y() / kCell_m))),
      rows_n_(std::max(1, static_cast<int>(gripper.jaw_size_m.z() / kCell_m))),
      low_(static_cast<std::size_t>(columns_n_) * static_cast<std::size_t>(rows_n_)),
      high_(low_) {}

void JawContacts::add(std::size_t part, const parts::Mesh& mesh,
                      const Eigen::Isometry3d& T_grasp_part) {
  std::vector<Eigen::Vector3d> vertices_m;
  vertices_m.reserve(mesh.vertices_m.size());
  for (const auto& vertex : mesh.vertices_m) {
    vertices_m.push_back(T_grasp_part * vertex.cast<double>());
  }
  for (const auto& triangle : mesh.triangles) {
    const std::array corners_m{vertices_m[static_cast<std::size_t>(triangle[0])],
                               vertices_m[static_cast<std::size_t>(triangle[1])],
                               vertices_m[static_cast<std::size_t>(triangle[2])]};
    Eigen::AlignedBox3d box_m(corners_m[0]);
    box_m.extend(corners_m[1]).extend(corners_m[2]);
    if (box_m.intersects(between_m_)) add_triangle(part, corners_m);
  }
}

void JawContacts::add_triangle(std::size_t part, const std::array<Eigen::Vector3d, 3>& corners_m) {
  const auto& [a, b, c] = corners_m;
  const Eigen::Vector3d area = (b - a).cross(c - a);
  if (area.x() == 0) return;  // seen on edge
  const Eigen::Vector3d normal = area.normalized();
  const auto span = [](double p_m, double q_m, double r_m, double first_m, int cells_n) {
    const auto [low, high] = std::minmax({p_m, q_m, r_m});
    return std::pair(
        std::max(0, static_cast<int>(std::ceil((low - first_m) / kCell_m - 0.5))),
        std::min(cells_n - 1, static_cast<int>(std::floor((high - first_m) / kCell_m - 0.5))));
  };
  const auto [u_first, u_last] = span(a.y(), b.y(), c.y(), between_m_.min().y(), columns_n_);
  const auto [v_first, v_last] = span(a.z(), b.z(), c.z(), between_m_.min().z(), rows_n_);
  for (int v = v_first; v <= v_last; ++v) {
    for (int u = u_first; u <= u_last; ++u) {
      Eigen::Vector3d p(0, between_m_.min().y() + (u + 0.5) * kCell_m,
                        between_m_.min().z() + (v + 0.5) * kCell_m);
      const auto share = [&](const Eigen::Vector3d& q, const Eigen::Vector3d& r) {
        return ((q - p).y() * (r - p).z() - (q - p).z() * (r - p).y()) / area.x();
      };
      const double of_a = share(b, c), of_b = share(c, a), of_c = share(a, b);
      if (of_a < 0 || of_b < 0 || of_c < 0) continue;
      p.x() = of_a * a.x() + of_b * b.x() + of_c * c.x();
      if (p.x() < between_m_.min().x() || p.x() > between_m_.max().x()) continue;
      const auto cell = static_cast<std::size_t>(v) * static_cast<std::size_t>(columns_n_) +
                        static_cast<std::size_t>(u);
      const Hit hit{true, {part, p, normal}};
      if (!low_[cell].is_there || p.x() < low_[cell].contact.p_m.x()) low_[cell] = hit;
      if (!high_[cell].is_there || p.x() > high_[cell].contact.p_m.x()) high_[cell] = hit;
    }
  }
}

std::vector<Contact> JawContacts::touched(const std::vector<Hit>& hits, double direction) {
  double first = std::numeric_limits<double>::lowest();
  for (const Hit& hit : hits) {
    if (hit.is_there) first = std::max(first, direction * hit.contact.p_m.x());
  }
  std::vector<Contact> contacts;
  for (const Hit& hit : hits) {
    if (hit.is_there && direction * hit.contact.p_m.x() >= first - kTouch_m) {
      contacts.push_back(hit.contact);
    }
  }
  return contacts;
}

bool in_force_closure(const std::vector<Contact>& low, const std::vector<Contact>& high,
                      double friction) {
  const double least_cosine = std::cos(std::atan(friction));
  return std::any_of(low.begin(), low.end(), [&](const Contact& a) {
    return std::any_of(high.begin(), high.end(), [&](const Contact& b) {
      const Eigen::Vector3d line = (b.p_m - a.p_m).normalized();
      return line.x() >= least_cosine && -line.dot(a.normal) >= least_cosine &&
             line.dot(b.normal) >= least_cosine;
    });
  });
}

}  // namespace graspd::judge
