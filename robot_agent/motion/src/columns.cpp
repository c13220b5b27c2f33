#include "columns.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

namespace graspd::motion {

std::vector<Column> columns_of(std::span<const Eigen::Vector3f> p_base_m, double edge_m,
                               const std::function<bool(const Eigen::Vector3d&)>& counts) {
  std::map<std::pair<int, int>, double> tops_m;
  for (const Eigen::Vector3f& p : p_base_m) {
    const Eigen::Vector3d p_m = p.cast<double>();
    if (!p_m.allFinite() || !counts(p_m)) continue;
    const std::pair square(static_cast<int>(std::floor(p_m.x() / edge_m)),
                           static_cast<int>(std::floor(p_m.y() / edge_m)));
    const auto [it, is_new] = tops_m.try_emplace(square, p_m.z());
    it->second = std::max(it->second, p_m.z());
  }
  std::vector<Column> columns;
  columns.reserve(tops_m.size());
  for (const auto& [square, top_m] : tops_m) {
    columns.push_back({{(square.first + 0.5) * edge_m, (square.second + 0.5) * edge_m}, top_m});
  }
  return columns;
}

}  // namespace graspd::motion
