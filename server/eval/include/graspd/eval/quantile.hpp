#pragma once

#include <vector>

namespace graspd::eval {

/// The value below which a share of the values lies, between two of them by linear interpolation.
/// \param values in any order, at least one. \param share in [0, 1]; 0.5 is the median.
double quantile(std::vector<double> values, double share);

}  // namespace graspd::eval
