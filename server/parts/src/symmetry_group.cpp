#include "symmetry_group.hpp"

#include <algorithm>
#include <cmath>

namespace graspd::parts {
namespace {

constexpr double kSameTranslation_m = 1e-4;

bool is_same(const Eigen::Isometry3d& a, const Eigen::Isometry3d& b, double same_angle_rad) {
  const Eigen::Quaterniond turn(a.linear().transpose() * b.linear());
  return turn.angularDistance(Eigen::Quaterniond::Identity()) < same_angle_rad &&
         (a.translation() - b.translation()).norm() < kSameTranslation_m;
}

/// Of two unit quaternions: 1 or −1 where they are the same turn.
double likeness(const Eigen::Quaterniond& a, const Eigen::Quaterniond& b) {
  return a.coeffs().dot(b.coeffs());
}

/// Row by row, which element the product of two is meant to be.
std::vector<std::size_t> product_table(const std::vector<Eigen::Quaterniond>& group) {
  std::vector<std::size_t> table;
  for (const Eigen::Quaterniond& a : group) {
    for (const Eigen::Quaterniond& b : group) {
      const Eigen::Quaterniond product = a * b;
      const auto meant = std::max_element(group.begin(), group.end(), [&](auto& c, auto& d) {
        return std::abs(likeness(c, product)) < std::abs(likeness(d, product));
      });
      table.push_back(static_cast<std::size_t>(meant - group.begin()));
    }
  }
  return table;
}

/// For each element the mean of all products of two that should make it.
std::vector<Eigen::Quaterniond> mean_products(const std::vector<Eigen::Quaterniond>& group,
                                              const std::vector<std::size_t>& table) {
  std::vector<Eigen::Vector4d> sums(group.size(), Eigen::Vector4d::Zero());
  auto meant = table.begin();
  for (const Eigen::Quaterniond& a : group) {
    for (const Eigen::Quaterniond& b : group) {
      const Eigen::Quaterniond product = a * b;
      const double sign = likeness(product, group[*meant]) < 0 ? -1 : 1;
      sums[*meant++] += sign * product.coeffs();
    }
  }
  std::vector<Eigen::Quaterniond> means;
  means.reserve(sums.size());
  for (const Eigen::Vector4d& sum : sums) means.emplace_back(sum.normalized());
  return means;
}

}  // namespace

Result<std::vector<Eigen::Isometry3d>> close_group(const std::vector<Eigen::Isometry3d>& generators,
                                                   double same_angle_rad) {
  std::vector<Eigen::Isometry3d> group{Eigen::Isometry3d::Identity()};
  // The list grows while it is walked: each element is multiplied with each generator once.
  for (std::size_t i = 0; i < group.size(); ++i) {
    for (const Eigen::Isometry3d& generator : generators) {
      Eigen::Isometry3d product = group[i] * generator;
      product.linear() = Eigen::Quaterniond(product.linear()).normalized().toRotationMatrix();
      const bool is_known = std::any_of(group.begin(), group.end(), [&](const auto& element) {
        return is_same(element, product, same_angle_rad);
      });
      if (is_known) continue;
      if (group.size() == kMaxGroupSize) {
        return invalid(
            "the discrete symmetries make a group of more than {} poses: write angles as 360/n, "
            "axes through one point, and a full turn as a continuous symmetry",
            kMaxGroupSize);
      }
      group.push_back(product);
    }
  }
  group.erase(group.begin());
  return group;
}

void make_exact(std::vector<Eigen::Isometry3d>& group) {
  // After Grove, Karcher and Ruh (1974): each round squares the error, up to one turn common to
  // all, which the element that should be the identity shows.
  constexpr int kRounds = 4;
  std::vector<Eigen::Quaterniond> turns{Eigen::Quaterniond::Identity()};
  for (const Eigen::Isometry3d& T : group) turns.emplace_back(T.linear());
  const std::vector<std::size_t> table = product_table(turns);
  for (int round = 0; round < kRounds; ++round) {
    turns = mean_products(turns, table);
    const Eigen::Quaterniond common = turns.front().conjugate();
    for (Eigen::Quaterniond& turn : turns) turn = (turn * common).normalized();
  }
  for (std::size_t i = 0; i < group.size(); ++i) {
    group[i].linear() = turns[i + 1].toRotationMatrix();
  }
}

}  // namespace graspd::parts
