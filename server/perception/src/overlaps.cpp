#include "overlaps.hpp"

#include <limits>
#include <numeric>

namespace graspd::perception {
namespace {

/// Of a level surface, a facet or two are in each column.
constexpr float kColumn_m = 0.008f;
/// Of a unit normal's z. Steeper surfaces are walls: they are neither over nor under anything.
constexpr float kMinUpright = 0.3f;

/// A piece of a surface that looks up or down.
struct PlacedFacet {
  std::uint32_t part = 0, column = 0;
  bool looks_up = false;
  Eigen::Vector3f p_m = Eigen::Vector3f::Zero();
  Eigen::Vector2f slope = Eigen::Vector2f::Zero();  ///< of its tangent plane: rise of z per metre

  float z_at_m(const Eigen::Vector3f& q_m) const {
    return p_m.z() + slope.dot((q_m - p_m).head<2>());
  }
};

/// The facets of all parts, column by column.
struct Columns {
  std::vector<PlacedFacet> facets;
  std::vector<std::uint32_t> first;  ///< of each column; and the end
};

Columns sort_into_columns(std::span<const PlacedPart> parts) {
  std::vector<PlacedFacet> facets;
  Eigen::Array2f low_m = Eigen::Array2f::Constant(std::numeric_limits<float>::max());
  Eigen::Array2f high_m = -low_m;
  for (std::uint32_t i = 0; i < parts.size(); ++i) {
    const Eigen::Isometry3f T_floor_part = parts[i].T_floor_part.cast<float>();
    for (const parts::Facet& facet : parts[i].part->contact.facets()) {
      const Eigen::Vector3f n = T_floor_part.linear() * facet.normal;
      if (std::abs(n.z()) < kMinUpright) continue;
      const Eigen::Vector3f p_m = T_floor_part * facet.position_m;
      facets.push_back({i, 0, n.z() > 0, p_m, -n.head<2>() / n.z()});
      low_m = low_m.min(p_m.array().head<2>());
      high_m = high_m.max(p_m.array().head<2>());
    }
  }
  Columns columns;
  if (facets.empty()) return columns;
  const Eigen::Array2i size = ((high_m - low_m) / kColumn_m).cast<int>() + 1;
  columns.first.resize(static_cast<std::size_t>(size.prod()) + 1);
  for (PlacedFacet& facet : facets) {
    const Eigen::Array2i cell = ((facet.p_m.array().head<2>() - low_m) / kColumn_m).cast<int>();
    facet.column = static_cast<std::uint32_t>(cell.y() * size.x() + cell.x());
    ++columns.first[facet.column + 1];
  }
  std::partial_sum(columns.first.begin(), columns.first.end(), columns.first.begin());
  std::vector<std::uint32_t> next(columns.first.begin(), columns.first.end() - 1);
  columns.facets.resize(facets.size());
  for (const PlacedFacet& facet : facets) columns.facets[next[facet.column]++] = facet;
  return columns;
}

}  // namespace

Pairs<int> find_overlaps(std::span<const PlacedPart> parts, double tolerance_m) {
  const Columns columns = sort_into_columns(parts);
  const auto below_m = static_cast<float>(tolerance_m);
  Pairs<int> over(parts.size());
  Pairs<std::uint32_t> counted_in(parts.size());  // this column and the ones before it
  const auto count_once = [&](std::uint32_t upper, std::uint32_t lower, std::uint32_t column) {
    if (counted_in(upper, lower) > column) return;
    counted_in(upper, lower) = column + 1;
    ++over(upper, lower);
  };
  for (std::size_t i = 0; i < columns.facets.size(); ++i) {
    const PlacedFacet& lower = columns.facets[i];
    count_once(lower.part, lower.part, lower.column);
    if (!lower.looks_up) continue;
    for (std::uint32_t k = columns.first[lower.column]; k < columns.first[lower.column + 1]; ++k) {
      const PlacedFacet& upper = columns.facets[k];
      if (upper.looks_up || upper.part == lower.part) continue;
      if (upper.p_m.z() > lower.z_at_m(upper.p_m) - below_m) {
        count_once(upper.part, lower.part, lower.column);
      }
    }
  }
  return over;
}

}  // namespace graspd::perception
