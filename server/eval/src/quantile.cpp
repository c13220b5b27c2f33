#include "graspd/eval/quantile.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace graspd::eval {

double quantile(std::vector<double> values, double share) {
  if (values.empty()) throw std::invalid_argument("quantile: of no values");
  std::sort(values.begin(), values.end());
  const double place = share * static_cast<double>(values.size() - 1);
  const auto below = static_cast<std::size_t>(place);
  const std::size_t above = std::min(below + 1, values.size() - 1);
  return std::lerp(values[below], values[above], place - static_cast<double>(below));
}

}  // namespace graspd::eval
