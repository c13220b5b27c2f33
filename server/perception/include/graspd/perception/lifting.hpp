#pragma once

#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <vector>

#include "graspd/perception/grs.hpp"
#include "graspd/perception/parameters.hpp"
#include "graspd/types/request.hpp"

namespace graspd::perception {

/// What happens when a part is lifted straight up: which parts lie on it or hook it, and whether it
/// meets a wall. Each part is a map of columns over the floor with its lowest and its highest point
/// in each; a part is in the way where it has something above the lowest point of the lifted one.
/// Noise moves silhouettes by a column, so that parts side by side share some: only three by three
/// columns, `lift_overlap_m` wide, count.
class Lifting {
 public:
  Lifting(std::span<const PlacedPart> parts, const CollisionParameters& parameters);

  /// The first part that would be lifted or hooked.
  std::optional<std::uint32_t> in_the_way(std::size_t target) const;
  /// Whether, on its way, the part goes through a wall.
  bool meets_wall(std::size_t target, const Bin& bin) const;

 private:
  static constexpr float kNone_m = std::numeric_limits<float>::max();

  struct Columns {
    int x_first = 0, y_first = 0, width = 0, height = 0;
    std::vector<float> low_m, high_m;                ///< low above high where the part is not
    float lowest_m = kNone_m, highest_m = -kNone_m;  ///< of all

    std::size_t index(int x, int y) const {
      return static_cast<std::size_t>(y - y_first) * static_cast<std::size_t>(width) +
             static_cast<std::size_t>(x - x_first);
    }
  };

  Columns columns_of(const PlacedPart& part) const;
  bool is_in_the_way(const Columns& other, const Columns& lifted) const;

  double column_m_;
  float tolerance_m_;
  std::vector<Columns> columns_;
};

}  // namespace graspd::perception
