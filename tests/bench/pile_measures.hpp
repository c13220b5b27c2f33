#pragma once

#include <Eigen/Geometry>
#include <algorithm>
#include <map>
#include <utility>
#include <vector>

#include "graspd/perception/placed_part.hpp"
#include "graspd/simulation/pile_physics.hpp"

/// A pile's graph and ranking against what physics says of the pile.
namespace graspd::bench {

/// A pile at rest with its true poses, and what physics says of it.
class PileTruth {
 public:
  /// \param kinds of the pile, as `physics` knows them.
  PileTruth(const simulation::Pile& pile, const Eigen::Vector3d& bin_inner_size_m,
            const std::vector<const parts::Part*>& kinds, const simulation::PilePhysics& physics);

  const std::vector<perception::PlacedPart>& parts() const { return parts_; }
  /// One part bears a tenth of another's weight or more, and is not borne by it even more.
  bool lies_on(std::size_t upper, std::size_t lower) const;
  bool is_supporting(std::size_t part) const;
  /// How the others move when this one is lifted straight up. Computed when first asked.
  const std::vector<simulation::Moved>& lift(std::size_t part) const;
  /// The farthest way that another part goes; the highest rise.
  double disturbance_m(std::size_t part) const;
  bool takes_along(std::size_t part) const;

 private:
  const simulation::PilePhysics* physics_;
  Eigen::Vector3d bin_inner_size_m_;
  std::vector<perception::PlacedPart> parts_;
  std::vector<simulation::PiledPart> piled_;
  std::map<std::pair<std::size_t, std::size_t>, double> shares_;  ///< (upper, lower)
  mutable std::map<std::size_t, std::vector<simulation::Moved>> lifts_;
};

struct Agreement {
  int both_n = 0, only_said_n = 0, only_true_n = 0;

  void add(bool said, bool is_true) {
    both_n += said && is_true;
    only_said_n += said && !is_true;
    only_true_n += !said && is_true;
  }
  double precision() const { return double(both_n) / std::max(1, both_n + only_said_n); }
  double recall() const { return double(both_n) / std::max(1, both_n + only_true_n); }
};

/// Says how well a number tells two kinds apart: the share of pairs in which the one that it is
/// true of has the larger number.
class Separation {
 public:
  void add(double value, bool is_true) { (is_true ? true_ : false_).push_back(value); }
  double auc() const;
  /// Of all "value > threshold", the one whose hit rate exceeds its false alarm rate by most.
  struct Threshold {
    double value = 0, hit_rate = 0, false_alarm_rate = 0;
  };
  Threshold best() const;
  Threshold at(double value) const;

 private:
  std::vector<double> true_, false_;
};

}  // namespace graspd::bench
