#include "anno_ik.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

#include "joint_limits.hpp"

/// Standard Denavit-Hartenberg (θ, d, a, α): (q1, d1, 0, π/2), (q2 + π/2, 0, a2, 0),
/// (q3, 0, 0, π/2), (q4, d4, 0, -π/2), (q5 - π/2, 0, 0, π/2), (q6, d6, 0, 0); then the flange is
/// turned by 180° about x. With γ = q3 - π/2 and φ = q2 + π/2 the wrist is at
///   r = a2 cos φ + d4 cos(φ + γ),  h = d1 + a2 sin φ + d4 sin(φ + γ)
/// in the plane of q1, and the wrist's rotation is Rz(q4) Ry(q5 - π/2) Rz(q6).
namespace graspd::motion {
namespace {

using std::numbers::pi;
/// Below this a sine or a radius says no angle: the joint stays where it was.
constexpr double kSingular = 1e-9;

struct Lengths {
  double d1_m = 0;
  double a2_m = 0;
  double d4_m = 0;
  double d6_m = 0;
};

Eigen::Matrix3d about_x(double q_rad) {
  return Eigen::AngleAxisd(q_rad, Eigen::Vector3d::UnitX()).toRotationMatrix();
}
Eigen::Matrix3d about_y(double q_rad) {
  return Eigen::AngleAxisd(q_rad, Eigen::Vector3d::UnitY()).toRotationMatrix();
}
Eigen::Matrix3d about_z(double q_rad) {
  return Eigen::AngleAxisd(q_rad, Eigen::Vector3d::UnitZ()).toRotationMatrix();
}

/// Of the frame in which the wrist turns; its z is along the forearm.
Eigen::Matrix3d forearm_rotation(double q1_rad, double q2_rad, double q3_rad) {
  return about_z(q1_rad) * about_y(-(q2_rad + q3_rad + pi / 2)) * about_x(pi);
}

Eigen::Isometry3d T_base_flange(const Lengths& of, const agent::Joints& q_rad) {
  const double upper_rad = q_rad[1] + pi / 2;
  const double fore_rad = q_rad[1] + q_rad[2];
  const Eigen::Matrix3d R_base_tip = forearm_rotation(q_rad[0], q_rad[1], q_rad[2]) *
                                     about_z(q_rad[3]) * about_y(q_rad[4] - pi / 2) *
                                     about_z(q_rad[5]);
  const double r_m = of.a2_m * std::cos(upper_rad) + of.d4_m * std::cos(fore_rad);
  const double h_m = of.d1_m + of.a2_m * std::sin(upper_rad) + of.d4_m * std::sin(fore_rad);
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  T.translation() = about_z(q_rad[0]) * Eigen::Vector3d(r_m, 0, h_m) + of.d6_m * R_base_tip.col(2);
  T.linear() = R_base_tip * about_x(pi);
  return T;
}

class AnnoIk final : public InverseKinematics {
 public:
  AnnoIk(ArmModel arm, const Lengths& lengths) : arm_(std::move(arm)), of_(lengths) {}

  Result<std::vector<agent::Joints>> solve(const Eigen::Isometry3d& T_base_flange,
                                           const agent::Joints& near_rad) override {
    const auto all_rad = branches(T_base_flange, near_rad);
    if (!all_rad) return tl::unexpected(all_rad.error());
    std::vector<agent::Joints> within_rad;
    for (const agent::Joints& q_rad : *all_rad) {
      if (!beyond_limits(q_rad, arm_.limits())) within_rad.push_back(q_rad);
    }
    if (within_rad.empty()) {
      return invalid("{}", *beyond_limits(all_rad->front(), arm_.limits()));
    }
    return within_rad;
  }

  Result<agent::Joints> follow(const Eigen::Isometry3d& T_base_flange,
                               const agent::Joints& near_rad) override {
    const auto all_rad = branches(T_base_flange, near_rad);
    if (!all_rad) return tl::unexpected(all_rad.error());
    if (const auto beyond = beyond_limits(all_rad->front(), arm_.limits())) {
      return invalid("{}", *beyond);
    }
    return all_rad->front();
  }

 private:
  /// Up to eight, nearest first, limits or not.
  Result<std::vector<agent::Joints>> branches(const Eigen::Isometry3d& T_base_flange,
                                              const agent::Joints& near_rad) const {
    // The flange's z points into the arm.
    const Eigen::Vector3d p_wrist_m =
        T_base_flange.translation() + of_.d6_m * T_base_flange.linear().col(2);
    const double h_m = p_wrist_m.z() - of_.d1_m;
    const double r_m = p_wrist_m.head<2>().norm();
    const double reach_m = std::hypot(r_m, h_m);
    if (reach_m > of_.a2_m + of_.d4_m || reach_m < std::abs(of_.a2_m - of_.d4_m)) {
      return invalid("the wrist would be {:.3f} m from the shoulder, and gets to {:.3f} to {:.3f}",
                     reach_m, std::abs(of_.a2_m - of_.d4_m), of_.a2_m + of_.d4_m);
    }
    const double q1_rad = r_m < kSingular ? near_rad[0] : std::atan2(p_wrist_m.y(), p_wrist_m.x());
    const double cos_elbow =
        (reach_m * reach_m - of_.a2_m * of_.a2_m - of_.d4_m * of_.d4_m) / (2 * of_.a2_m * of_.d4_m);
    const double elbow_rad = std::acos(std::clamp(cos_elbow, -1.0, 1.0));

    std::vector<agent::Joints> all_rad;
    for (const double side : {1.0, -1.0}) {  // the arm reaches forward, or back over its head
      for (const double gamma_rad : {elbow_rad, -elbow_rad}) {
        const double phi_rad =
            std::atan2(h_m, side * r_m) -
            std::atan2(of_.d4_m * std::sin(gamma_rad), of_.a2_m + of_.d4_m * std::cos(gamma_rad));
        const Eigen::Vector3d shoulder_rad(side > 0 ? q1_rad : q1_rad + pi, phi_rad - pi / 2,
                                           gamma_rad + pi / 2);
        add_wrists(T_base_flange.linear(), shoulder_rad, near_rad, all_rad);
      }
    }
    for (agent::Joints& q_rad : all_rad) q_rad = unwind(q_rad, near_rad, arm_.limits());
    sort_by_nearness(all_rad, near_rad);
    return all_rad;
  }

  /// The wrist's two ways, flipped against each other.
  static void add_wrists(const Eigen::Matrix3d& R_base_flange, const Eigen::Vector3d& shoulder_rad,
                         const agent::Joints& near_rad, std::vector<agent::Joints>& all_rad) {
    const Eigen::Matrix3d R =
        forearm_rotation(shoulder_rad[0], shoulder_rad[1], shoulder_rad[2]).transpose() *
        R_base_flange * about_x(-pi);
    const double sin_5 = std::hypot(R(0, 2), R(1, 2));
    for (const double sign : {1.0, -1.0}) {
      const double theta_5_rad = std::atan2(sign * sin_5, R(2, 2));
      double q4_rad = std::atan2(sign * R(1, 2), sign * R(0, 2));
      double q6_rad = std::atan2(sign * R(2, 1), -sign * R(2, 0));
      if (sin_5 < kSingular) {  // joints 4 and 6 turn about one axis
        q4_rad = near_rad[3];
        const Eigen::Matrix3d R_6 = about_y(-theta_5_rad) * about_z(-q4_rad) * R;
        q6_rad = std::atan2(R_6(1, 0), R_6(0, 0));
      }
      agent::Joints q_rad(6);
      q_rad << shoulder_rad, q4_rad, theta_5_rad + pi / 2, q6_rad;
      all_rad.push_back(std::move(q_rad));
    }
  }

  ArmModel arm_;
  Lengths of_;
};

/// From three poses in which they can be read off.
Lengths measure(const ArmModel& arm) {
  const auto flange_m = [&](double q2_rad, double q5_rad) -> Eigen::Vector3d {
    agent::Joints q_rad = agent::Joints::Zero(6);
    q_rad[1] = q2_rad;
    q_rad[4] = q5_rad;
    return arm.T_base_flange(q_rad).translation();
  };
  const Eigen::Vector3d down_m = flange_m(0, 0);                  // (d4, 0, d1 + a2 - d6)
  const Eigen::Vector3d ahead_m = flange_m(0, pi / 2);            // (d4 + d6, 0, d1 + a2)
  const Eigen::Vector3d stretched_m = flange_m(-pi / 2, pi / 2);  // (a2, 0, d1 - d4 - d6)
  Lengths of;
  of.d4_m = down_m.x();
  of.d6_m = ahead_m.x() - down_m.x();
  of.a2_m = stretched_m.x();
  of.d1_m = ahead_m.z() - of.a2_m;
  return of;
}

}  // namespace

Result<std::unique_ptr<InverseKinematics>> make_anno_ik(const ArmModel& arm) {
  if (arm.joints_n() != 6) {
    return invalid("arm '{}' has {} joints, an Anno 6: set ik: kdl", arm.name(), arm.joints_n());
  }
  const Lengths lengths = measure(arm);
  std::mt19937 random(1);
  std::uniform_real_distribution<double> uniform(-pi, pi);
  for (int i = 0; i < 20; ++i) {
    const agent::Joints q_rad = agent::Joints::NullaryExpr(6, [&] { return uniform(random); });
    constexpr double kSame = 1e-6;
    const Eigen::Isometry3d T = T_base_flange(lengths, q_rad);
    if (!T.isApprox(arm.T_base_flange(q_rad), kSame)) {
      return invalid(
          "arm '{}' is not built like an Anno (two links in a plane, then a spherical "
          "wrist): set ik: kdl",
          arm.name());
    }
  }
  return std::make_unique<AnnoIk>(arm, lengths);
}

}  // namespace graspd::motion
