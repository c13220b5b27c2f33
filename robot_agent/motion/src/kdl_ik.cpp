#include "kdl_ik.hpp"

#include <algorithm>
#include <kdl/chain.hpp>
#include <kdl/chainiksolverpos_lma.hpp>
#include <optional>
#include <random>

#include "arm_data.hpp"
#include "joint_limits.hpp"

namespace graspd::motion {
namespace {

constexpr int kStarts = 12;
constexpr int kIterations = 100;
/// Of the error in metres, and in radians times the weight of rotations.
constexpr double kAccuracy = 1e-7;
constexpr double kRotationWeight = 0.1;
constexpr double kAside_rad = 0.02;

KDL::Chain chain_to_flange(const ArmData& data) {
  std::vector<int> links;
  for (int i = data.flange; i >= 0; i = data.parents[static_cast<std::size_t>(i)]) {
    links.push_back(i);
  }
  KDL::Chain chain;
  std::for_each(links.rbegin(), links.rend(),
                [&](int i) { chain.addSegment(data.segments[static_cast<std::size_t>(i)]); });
  return chain;
}

KDL::Frame to_kdl(const Eigen::Isometry3d& T) {
  const Eigen::Matrix3d R = T.linear();
  return {KDL::Rotation(R(0, 0), R(0, 1), R(0, 2), R(1, 0), R(1, 1), R(1, 2), R(2, 0), R(2, 1),
                        R(2, 2)),
          KDL::Vector(T(0, 3), T(1, 3), T(2, 3))};
}

class KdlIk final : public InverseKinematics {
 public:
  explicit KdlIk(ArmModel arm)
      : arm_(std::move(arm)),
        chain_(chain_to_flange(arm_.data())),
        solver_(chain_, weights(), kAccuracy, kIterations) {
    std::mt19937 random(1);
    for (int i = 0; i < kStarts; ++i) {
      agent::Joints q_rad(arm_.joints_n());
      for (int j = 0; j < q_rad.size(); ++j) {
        const JointLimits& of = arm_.limits()[static_cast<std::size_t>(j)];
        q_rad[j] = std::uniform_real_distribution<double>(of.min_rad, of.max_rad)(random);
      }
      starts_rad_.push_back(q_rad);
    }
    for (const KDL::Segment& segment : chain_.segments) {
      reach_m_ += segment.getFrameToTip().p.Norm();
    }
  }

  Result<std::vector<agent::Joints>> solve(const Eigen::Isometry3d& T_base_flange,
                                           const agent::Joints& near_rad) override {
    const double away_m = T_base_flange.translation().norm();
    if (away_m > reach_m_) {
      return invalid("the flange would be {:.3f} m from the base, and gets to {:.3f}", away_m,
                     reach_m_);
    }
    std::vector<agent::Joints> within_rad;
    std::string why = "no joints were found that bring the flange there";
    const auto try_from = [&](const agent::Joints& start_rad) {
      const auto found_rad = run(T_base_flange, start_rad);
      if (!found_rad) return;
      agent::Joints q_rad = unwind(*found_rad, near_rad, arm_.limits());
      if (auto beyond = beyond_limits(q_rad, arm_.limits())) {
        why = *std::move(beyond);
      } else {
        within_rad.push_back(std::move(q_rad));
      }
    };
    try_from(near_rad);
    for (const agent::Joints& start_rad : starts_rad_) try_from(start_rad);
    if (within_rad.empty()) return invalid("{}", why);
    sort_by_nearness(within_rad, near_rad);
    return within_rad;
  }

  Result<agent::Joints> follow(const Eigen::Isometry3d& T_base_flange,
                               const agent::Joints& near_rad) override {
    auto found_rad = run(T_base_flange, near_rad);
    // Where axes line up the search goes nowhere; from beside that place it does.
    for (int j = 0; j < near_rad.size() && !found_rad; ++j) {
      for (const double aside_rad : {kAside_rad, -kAside_rad}) {
        if (found_rad) break;
        found_rad =
            run(T_base_flange, near_rad + aside_rad * agent::Joints::Unit(near_rad.size(), j));
      }
    }
    if (!found_rad) return invalid("no joints were found that bring the flange there");
    agent::Joints q_rad = unwind(*found_rad, near_rad, arm_.limits());
    if (const auto beyond = beyond_limits(q_rad, arm_.limits())) return invalid("{}", *beyond);
    return q_rad;
  }

 private:
  static Eigen::Matrix<double, 6, 1> weights() {
    Eigen::Matrix<double, 6, 1> weights;
    weights << 1, 1, 1, kRotationWeight, kRotationWeight, kRotationWeight;
    return weights;
  }

  std::optional<agent::Joints> run(const Eigen::Isometry3d& T_base_flange,
                                   const agent::Joints& start_rad) {
    KDL::JntArray start(static_cast<unsigned>(arm_.joints_n()));
    start.data = start_rad;
    KDL::JntArray q(static_cast<unsigned>(arm_.joints_n()));
    if (solver_.CartToJnt(start, to_kdl(T_base_flange), q) < 0) return std::nullopt;
    return q.data;
  }

  ArmModel arm_;
  KDL::Chain chain_;
  KDL::ChainIkSolverPos_LMA solver_;
  std::vector<agent::Joints> starts_rad_;
  double reach_m_ = 0;  ///< no flange is further from the base's origin
};

}  // namespace

std::unique_ptr<InverseKinematics> make_kdl_ik(const ArmModel& arm) {
  return std::make_unique<KdlIk>(arm);
}

}  // namespace graspd::motion
