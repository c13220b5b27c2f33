#include "symmetry_candidates.hpp"

#include <array>
#include <cmath>
#include <numbers>

namespace graspd::parts {
namespace {

constexpr double kUncertainty_rad = 0.01;  // of principal axes: flaws of the surface tilt them
constexpr int kCircleSteps = 180;
constexpr int kHalfSphereSteps = 1500;
constexpr double kHalfSphereStep_rad = 0.065;
constexpr double kNeighbourCosine = 0.995;  // one and a half steps
constexpr int kMaxDescents = 25;
constexpr double kStationaryUncertainty_rad = 0.02;

/// Calls `visit(place_m, area_m2)` so that sums over the surface come out exact for squares and
/// good for more: each triangle counts by the middles of its edges.
template <class Visit>
void for_each_place(const std::vector<Triangle>& triangles, const Visit& visit) {
  for (const Triangle& triangle : triangles) {
    const auto& [a, b, c] = triangle.corners_m;
    const double area_m2 = triangle.area_m2() / 3;
    visit(0.5 * (a + b), area_m2);
    visit(0.5 * (b + c), area_m2);
    visit(0.5 * (c + a), area_m2);
  }
}

/// Standard deviation of the surface along each axis.
Eigen::Vector3d spreads_m(const std::vector<Triangle>& triangles, const Eigen::Matrix3d& axes) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  double total_m2 = 0;
  for_each_place(triangles, [&](const Eigen::Vector3d& place_m, double area_m2) {
    sum += area_m2 * (axes.transpose() * place_m).cwiseAbs2();
    total_m2 += area_m2;
  });
  return (sum / total_m2).cwiseSqrt();
}

/// x⁰ … x⁶ of each coordinate.
using Powers = std::array<Eigen::Array3d, 7>;

Powers powers_of(const Eigen::Vector3d& p) {
  Powers powers;
  powers[0].setOnes();
  for (std::size_t n = 1; n < powers.size(); ++n) powers[n] = powers[n - 1] * p.array();
  return powers;
}

/// The mean over the surface of (p · w)ᵈ as a function of the direction w: a polynomial, whose
/// coefficients are the surface's moments of degree d times multinomial ones.
class DirectionalMoment {
 public:
  DirectionalMoment(const std::vector<Triangle>& triangles, int degree, double unit_m) {
    for (int i = 0; i <= degree; ++i) {
      for (int j = 0; i + j <= degree; ++j) terms_.push_back({i, j, degree - i - j, 0});
    }
    double total_m2 = 0;
    for_each_place(triangles, [&](const Eigen::Vector3d& place_m, double area_m2) {
      const Powers powers = powers_of(place_m / unit_m);
      for (Term& term : terms_) term.factor += area_m2 * product(powers, term.i, term.j, term.k);
      total_m2 += area_m2;
    });
    for (Term& term : terms_) {
      term.factor *= std::tgamma(degree + 1) /
                     (std::tgamma(term.i + 1) * std::tgamma(term.j + 1) * std::tgamma(term.k + 1)) /
                     total_m2;
    }
  }

  /// Along the unit sphere.
  Eigen::Vector3d gradient(const Eigen::Vector3d& w) const {
    const Powers powers = powers_of(w);
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    for (const auto& [i, j, k, factor] : terms_) {
      if (i > 0) sum.x() += factor * i * product(powers, i - 1, j, k);
      if (j > 0) sum.y() += factor * j * product(powers, i, j - 1, k);
      if (k > 0) sum.z() += factor * k * product(powers, i, j, k - 1);
    }
    return sum - sum.dot(w) * w;
  }

 private:
  struct Term {
    int i, j, k;
    double factor;
  };

  static double product(const Powers& powers, int i, int j, int k) {
    return powers[static_cast<std::size_t>(i)].x() * powers[static_cast<std::size_t>(j)].y() *
           powers[static_cast<std::size_t>(k)].z();
  }

  std::vector<Term> terms_;
};

/// Evenly over the half sphere z > 0: the Fibonacci lattice.
std::vector<Eigen::Vector3d> half_sphere() {
  std::vector<Eigen::Vector3d> directions;
  for (int i = 0; i < kHalfSphereSteps; ++i) {
    const double z = (i + 0.5) / kHalfSphereSteps;
    const double phi = 2 * std::numbers::pi * std::numbers::phi * i;
    const double r = std::sqrt(1 - z * z);
    directions.emplace_back(r * std::cos(phi), r * std::sin(phi), z);
  }
  return directions;
}

/// How far moments are from stationary in a direction.
class Unrest {
 public:
  explicit Unrest(const std::vector<Triangle>& triangles)
      : unit_m_(spreads_m(triangles, Eigen::Matrix3d::Identity()).norm()),
        fourth_(triangles, 4, unit_m_),
        sixth_(triangles, 6, unit_m_) {}

  double operator()(const Eigen::Vector3d& w) const {
    return fourth_.gradient(w).squaredNorm() + sixth_.gradient(w).squaredNorm();
  }

 private:
  double unit_m_;
  DirectionalMoment fourth_, sixth_;
};

/// Downhill on the sphere, by ever smaller steps; not many, since round parts have long valleys.
Eigen::Vector3d least_nearby(const Unrest& unrest, Eigen::Vector3d w) {
  double least = unrest(w);
  double step_rad = kHalfSphereStep_rad / 2;
  for (int i = 0; i < kMaxDescents; ++i) {
    const Eigen::Vector3d a = w.unitOrthogonal();
    const Eigen::Vector3d b = w.cross(a);
    Eigen::Vector3d best = w;
    for (const Eigen::Vector3d& aside : {a, b, Eigen::Vector3d(-a), Eigen::Vector3d(-b)}) {
      const Eigen::Vector3d next = (w + step_rad * aside).normalized();
      if (const double value = unrest(next); value < least) {
        least = value;
        best = next;
      }
    }
    if (best == w) step_rad /= 2;
    w = best;
  }
  return w;
}

/// Every moment of a surface is stationary on its axes of symmetry (Martinet et al., Accurate
/// Detection of Symmetries in 3D Shapes, 2006). \returns where the fourth and the sixth are
/// nearest to it.
std::vector<Eigen::Vector3d> stationary_directions(const std::vector<Triangle>& triangles) {
  const Unrest unrest(triangles);
  const std::vector<Eigen::Vector3d> directions = half_sphere();
  std::vector<double> values;
  for (const Eigen::Vector3d& w : directions) values.push_back(unrest(w));
  std::vector<Eigen::Vector3d> stationary;
  for (std::size_t i = 0; i < directions.size(); ++i) {
    bool is_least = true;
    for (std::size_t k = 0; k < directions.size() && is_least; ++k) {
      is_least =
          values[k] >= values[i] || std::abs(directions[i].dot(directions[k])) < kNeighbourCosine;
    }
    if (is_least) stationary.push_back(least_nearby(unrest, directions[i]));
  }
  return stationary;
}

}  // namespace

CandidateAxes candidate_axes(const std::vector<Triangle>& triangles,
                             const Eigen::Matrix3d& principal_axes, double alike_m) {
  CandidateAxes candidates;
  for (const auto& axis : principal_axes.colwise()) {
    candidates.axes.push_back({axis, kUncertainty_rad});
  }
  const Eigen::Vector3d spread_m = spreads_m(triangles, principal_axes);
  const bool are_longest_alike = spread_m[0] - spread_m[1] < alike_m;
  const bool are_shortest_alike = spread_m[1] - spread_m[2] < alike_m;
  if (are_longest_alike && are_shortest_alike) {
    for (const Eigen::Vector3d& direction : stationary_directions(triangles)) {
      candidates.axes.push_back({direction, kStationaryUncertainty_rad});
    }
  } else if (are_longest_alike || are_shortest_alike) {
    const Eigen::Vector3d a = principal_axes.col(1);
    const Eigen::Vector3d b = principal_axes.col(are_longest_alike ? 0 : 2);
    for (int i = 0; i < kCircleSteps; ++i) {
      const double phi = std::numbers::pi * i / kCircleSteps;
      candidates.across.push_back({std::cos(phi) * a + std::sin(phi) * b, kUncertainty_rad});
    }
  }
  return candidates;
}

}  // namespace graspd::parts
