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
  std::uint32_t part = 0;
  std::uint32_t bin = 0;
  Eigen::Vector3f p_m = Eigen::Vector3f::Zero();
  Eigen::Vector2f slope = Eigen::Vector2f::Zero();  ///< of its tangent plane: rise of z per metre

  float z_at_m(const Eigen::Vector3f& q_m) const {
    return p_m.z() + slope.dot((q_m - p_m).head<2>());
  }
};

/// The facets of all parts, column by column: first those that look down, then those that look up.
class Columns {
 public:
  explicit Columns(std::span<const PlacedPart> parts) {
    std::vector<PlacedFacet> facets;
    Eigen::Array2f low_m = Eigen::Array2f::Constant(std::numeric_limits<float>::max());
    Eigen::Array2f high_m = -low_m;
    for (std::uint32_t i = 0; i < parts.size(); ++i) {
      const Eigen::Isometry3f T_floor_part = parts[i].T_floor_part.cast<float>();
      for (const parts::Facet& facet : parts[i].part->contact.facets()) {
        const Eigen::Vector3f n = T_floor_part.linear() * facet.normal;
        if (std::abs(n.z()) < kMinUpright) continue;
        const Eigen::Vector3f p_m = T_floor_part * facet.position_m;
        facets.push_back({i, n.z() > 0 ? kUp : kDown, p_m, -n.head<2>() / n.z()});
        low_m = low_m.min(p_m.array().head<2>());
        high_m = high_m.max(p_m.array().head<2>());
      }
    }
    if (!facets.empty()) sort_into_bins(facets, low_m, high_m);
  }

  std::uint32_t size() const { return columns_n_; }
  std::span<const PlacedFacet> all(std::uint32_t column) const {
    return between(2 * column, 2 * column + 2);
  }
  std::span<const PlacedFacet> looking_down(std::uint32_t column) const {
    return between(2 * column + kDown, 2 * column + kDown + 1);
  }
  std::span<const PlacedFacet> looking_up(std::uint32_t column) const {
    return between(2 * column + kUp, 2 * column + kUp + 1);
  }

 private:
  static constexpr std::uint32_t kDown = 0;
  static constexpr std::uint32_t kUp = 1;

  std::span<const PlacedFacet> between(std::uint32_t bin, std::uint32_t end) const {
    return std::span(facets_).subspan(first_[bin], first_[end] - first_[bin]);
  }

  void sort_into_bins(std::vector<PlacedFacet>& facets, const Eigen::Array2f& low_m,
                      const Eigen::Array2f& high_m) {
    const Eigen::Array2i size = ((high_m - low_m) / kColumn_m).cast<int>() + 1;
    columns_n_ = static_cast<std::uint32_t>(size.prod());
    first_.resize(2 * std::size_t{columns_n_} + 1);
    for (PlacedFacet& facet : facets) {
      const Eigen::Array2i cell = ((facet.p_m.array().head<2>() - low_m) / kColumn_m).cast<int>();
      facet.bin += 2 * static_cast<std::uint32_t>(cell.y() * size.x() + cell.x());
      ++first_[facet.bin + 1];
    }
    std::partial_sum(first_.begin(), first_.end(), first_.begin());
    std::vector<std::uint32_t> next(first_.begin(), first_.end() - 1);
    facets_.resize(facets.size());
    for (const PlacedFacet& facet : facets) facets_[next[facet.bin]++] = facet;
  }

  std::uint32_t columns_n_ = 0;
  std::vector<PlacedFacet> facets_;
  std::vector<std::uint32_t> first_;  ///< of each bin, two to a column; and the end
};

}  // namespace

Pairs<int> find_overlaps(std::span<const PlacedPart> parts, double tolerance_m) {
  const Columns columns(parts);
  const auto below_m = static_cast<float>(tolerance_m);
  Pairs<int> over(parts.size());
  Pairs<std::uint32_t> counted_in(parts.size());  // this column and the ones before it
  for (std::uint32_t column = 0; column < columns.size(); ++column) {
    const auto is_counted = [&](std::uint32_t upper, std::uint32_t lower) {
      return counted_in(upper, lower) > column;
    };
    const auto count = [&](std::uint32_t upper, std::uint32_t lower) {
      counted_in(upper, lower) = column + 1;
      ++over(upper, lower);
    };
    for (const auto& [part, bin, p_m, slope] : columns.all(column)) {
      if (!is_counted(part, part)) count(part, part);
    }
    for (const PlacedFacet& lower : columns.looking_up(column)) {
      for (const PlacedFacet& upper : columns.looking_down(column)) {
        // Of itself every part is counted already.
        if (is_counted(upper.part, lower.part)) continue;
        if (upper.p_m.z() > lower.z_at_m(upper.p_m) - below_m) count(upper.part, lower.part);
      }
    }
  }
  return over;
}

}  // namespace graspd::perception
