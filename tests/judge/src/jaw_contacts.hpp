#pragma once

#include <Eigen/Geometry>
#include <array>
#include <cstddef>
#include <vector>

#include "graspd/parts/mesh.hpp"
#include "graspd/types/request.hpp"

namespace graspd::judge {

/// Where a closing jaw meets a surface, in the grasp's frame.
struct Contact {
  std::size_t part = 0;
  Eigen::Vector3d p_m = Eigen::Vector3d::Zero();
  Eigen::Vector3d normal = Eigen::Vector3d::Zero();  ///< unit, out of the part
};

/// What lies between two open jaws, seen from each: of parallel rays from the jaw's face the first
/// hits, half a millimetre apart.
class JawContacts {
 public:
  JawContacts(const Gripper& gripper, double opening_width_m);

  /// The rectangle between the jaws' faces, in the grasp's frame.
  const Eigen::AlignedBox3d& between_m() const { return between_m_; }
  void add(std::size_t part, const parts::Mesh& mesh, const Eigen::Isometry3d& T_grasp_part);

  /// What each jaw touches where it first touches something: within half a millimetre as near.
  /// None where there is nothing between the jaws.
  std::vector<Contact> at_low_jaw() const { return touched(low_, -1); }
  std::vector<Contact> at_high_jaw() const { return touched(high_, 1); }

 private:
  struct Hit {
    bool is_there = false;
    Contact contact;
  };

  void add_triangle(std::size_t part, const std::array<Eigen::Vector3d, 3>& corners_m);
  static std::vector<Contact> touched(const std::vector<Hit>& hits, double direction);

  Eigen::AlignedBox3d between_m_;
  int columns_n_, rows_n_;  ///< along y, along z
  std::vector<Hit> low_, high_;
};

/// Force closure of two soft fingers (Nguyen 1988): two contacts whose line lies within the
/// friction cones of both. The jaws can push along the closing direction only, so that it must lie
/// within the cone about that as well.
bool in_force_closure(const std::vector<Contact>& low, const std::vector<Contact>& high,
                      double friction);

}  // namespace graspd::judge
