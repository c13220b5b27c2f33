#include "logistic_regression.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <utility>

namespace graspd::bench {
namespace {

constexpr int kNewtonSteps = 30;
constexpr double kRidge = 1e-6;

}  // namespace

Eigen::VectorXd fit_log_odds(const std::vector<Sample>& samples) {
  const Eigen::Index terms_n = samples.front().terms.size();
  Eigen::VectorXd weights = Eigen::VectorXd::Zero(terms_n);
  for (int step = 0; step < kNewtonSteps; ++step) {
    Eigen::MatrixXd hessian = kRidge * Eigen::MatrixXd::Identity(terms_n, terms_n);
    Eigen::VectorXd gradient = Eigen::VectorXd::Zero(terms_n);
    for (const Sample& sample : samples) {
      const double probability = 1 / (1 + std::exp(-weights.dot(sample.terms)));
      gradient += (double(sample.is_right) - probability) * sample.terms;
      hessian += probability * (1 - probability) * sample.terms * sample.terms.transpose();
    }
    weights += hessian.ldlt().solve(gradient);
  }
  return weights;
}

double auc(const std::vector<Sample>& samples, const std::vector<double>& values) {
  std::vector<std::pair<double, bool>> ranked;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    ranked.emplace_back(values[i], samples[i].is_right);
  }
  std::sort(ranked.begin(), ranked.end());
  double wrong_n = 0, before_n = 0;
  for (const auto& [_, is_right] : ranked) {
    if (is_right) {
      before_n += wrong_n;
    } else {
      ++wrong_n;
    }
  }
  const double right_n = static_cast<double>(ranked.size()) - wrong_n;
  return before_n / std::max(1.0, right_n * wrong_n);
}

}  // namespace graspd::bench
