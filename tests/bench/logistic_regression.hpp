#pragma once

#include <Eigen/Core>
#include <vector>

namespace graspd::bench {

/// An outcome, and what may tell of it. The first term is 1.
struct Sample {
  Eigen::VectorXd terms;
  bool is_right = false;
};

/// The weights of the terms in the log odds of being right, by Newton's method.
Eigen::VectorXd fit_log_odds(const std::vector<Sample>& samples);

/// How often a right one comes before a wrong one when they are ranked by `values`, one of each.
double auc(const std::vector<Sample>& samples, const std::vector<double>& values);

}  // namespace graspd::bench
