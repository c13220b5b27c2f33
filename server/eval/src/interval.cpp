#include "graspd/eval/interval.hpp"

#include <algorithm>
#include <cmath>

namespace graspd::eval {

Interval wilson(int hits_n, int all_n) {
  if (all_n == 0) return {0, 1};
  constexpr double z = 1.959964;
  const double n = all_n, p = hits_n / n;
  const double centre = (p + z * z / (2 * n)) / (1 + z * z / n);
  const double half = z / (1 + z * z / n) * std::sqrt(p * (1 - p) / n + z * z / (4 * n * n));
  return {std::max(0.0, centre - half), std::min(1.0, centre + half)};
}

}  // namespace graspd::eval
