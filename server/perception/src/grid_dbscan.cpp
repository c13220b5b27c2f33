#include "graspd/perception/grid_dbscan.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

#include "dbscan_steps.hpp"
#include "neighbour_kernel.hpp"

namespace graspd::perception {
namespace {

constexpr float kNowhere_m = std::numeric_limits<float>::quiet_NaN();
constexpr std::size_t kWordBits = 32;

std::uint32_t bit_of(std::size_t t) { return std::uint32_t{1} << (t % kWordBits); }
std::size_t words_of(std::size_t bits) { return (bits + kWordBits - 1) / kWordBits; }

/// Squared bound of how far apart, on the plane z = 1, the rays of `p_m` and of any point within
/// Eps of it are. With r the ray of p and q = p + e, they differ by (e.xy − r·e.z) / (z + e.z),
/// whose norm is at most Eps·√(1 + |r|²) / (z − Eps).
float reach2(const Eigen::Vector3f& p_m, float eps_m) {
  if (p_m.z() <= eps_m) return std::numeric_limits<float>::max();
  constexpr float kRounding = 1.001F;
  const float depth_m = p_m.z() - eps_m;
  return kRounding * eps_m * eps_m * (1 + (p_m.head<2>() / p_m.z()).squaredNorm()) /
         (depth_m * depth_m);
}

}  // namespace

/// Calls visit(tap) for each core neighbour's tap that `among`, a mask, has; the nearest rays
/// first.
template <class Visit>
void GridDbscan::for_core(const Place& here, const std::vector<std::uint32_t>& among,
                          Visit visit) const {
  const std::size_t words = words_of(taps_n_[here.row]);
  for (std::size_t word = 0; word < words; ++word) {
    std::uint32_t bits = masks_[here.mask + word * mask_stride_] & among[word];
    for (; bits != 0; bits &= bits - 1) {
      visit(taps_[word * kWordBits + static_cast<std::size_t>(std::countr_zero(bits))]);
    }
  }
}

/// The neighbourhoods as dbscan_steps.hpp wants them.
class GridDbscan::Reach {
 public:
  explicit Reach(const GridDbscan& grid) : grid_(grid) {}
  template <class Visit>
  void visit_core(std::uint32_t i, Visit visit) const {
    const Place& here = grid_.places_[i];
    grid_.for_core(here, grid_.every_tap_, [&](const Tap& tap) {
      const std::size_t there = here.pixel + tap.offset;
      visit(grid_.point_at_[there], grid_.distance2_m2(here.pixel, there));
    });
  }
  /// Holds until the next one.
  auto common_with(std::uint32_t i) const {
    const Place& here = grid_.places_[i];
    neighbours_.clear();
    for (std::size_t t = 0; t < grid_.taps_n_[here.row]; ++t) {
      const std::size_t there = here.pixel + grid_.taps_[t].offset;
      if (is_near(here.pixel, there)) neighbours_.push_back(there);
    }
    return [this](std::uint32_t j) {
      const std::size_t other = grid_.places_[j].pixel;
      return static_cast<std::size_t>(
          std::count_if(neighbours_.begin(), neighbours_.end(),
                        [&](std::size_t there) { return is_near(other, there); }));
    };
  }

 private:
  bool is_near(std::size_t a, std::size_t b) const {
    return grid_.distance2_m2(a, b) <= grid_.eps2_m2_;
  }

  const GridDbscan& grid_;
  mutable std::vector<std::size_t> neighbours_;  ///< of the last `common_with`
};

GridDbscan::GridDbscan(const Cloud& cloud, float eps_m, int min_points_n)
    : cloud_(cloud),
      eps2_m2_(eps_m * eps_m),
      is_core_(cloud.size()),
      width_(static_cast<std::size_t>(cloud.pixels.width_px)),
      height_(static_cast<std::size_t>(cloud.pixels.height_px)) {
  if (cloud.empty()) return;
  std::vector<float> row_reach2(height_, 0);
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    float& reach = row_reach2[cloud.cells[i] / width_];
    reach = std::max(reach, reach2(cloud.points_m[i], eps_m));
  }
  make_window(row_reach2);
  place_points();
  const std::vector<std::int32_t> neighbours_n = mark_all_neighbours(z_m_);
  std::vector<float> core_z_m(z_m_.size(), kNowhere_m);
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    is_core_[i] = neighbours_n[i] >= min_points_n;
    core_z_m[places_[i].pixel] = is_core_[i] ? cloud.points_m[i].z() : kNowhere_m;
  }
  mark_all_neighbours(core_z_m);
}

void GridDbscan::make_window(const std::vector<float>& row_reach2) {
  const PixelGrid& pixels = cloud_.pixels;
  const float most2 = *std::max_element(row_reach2.begin(), row_reach2.end());
  const float widest_px = std::sqrt(most2) * std::max(pixels.fx_px, pixels.fy_px);
  const auto image_px = static_cast<float>(std::max(width_, height_));
  const auto margin = static_cast<int>(std::min(widest_px, image_px));
  margin_ = static_cast<std::size_t>(margin);
  stride_ = width_ + 2 * margin_;
  mask_stride_ = width_ + kNeighbourPadding;
  for (int v = -margin; v <= margin; ++v) {
    for (int u = -margin; u <= margin; ++u) {
      const Eigen::Vector2f between(static_cast<float>(u) / pixels.fx_px,
                                    static_cast<float>(v) / pixels.fy_px);
      if (between.squaredNorm() > most2) continue;
      taps_.push_back({between.squaredNorm(), v * static_cast<std::ptrdiff_t>(stride_) + u});
    }
  }
  std::stable_sort(taps_.begin(), taps_.end(),
                   [](const Tap& a, const Tap& b) { return a.distance2 < b.distance2; });
  every_tap_.assign(words_of(taps_.size()), ~std::uint32_t{0});
  taps_before_.assign(every_tap_.size(), 0);
  for (std::size_t t = 0; t < taps_.size(); ++t) {
    if (taps_[t].offset < 0) taps_before_[t / kWordBits] |= bit_of(t);
  }
  const auto is_beyond = [](float reach, const Tap& tap) { return reach < tap.distance2; };
  for (const float reach : row_reach2) {
    taps_n_.push_back(static_cast<std::size_t>(
        std::upper_bound(taps_.begin(), taps_.end(), reach, is_beyond) - taps_.begin()));
  }
}

void GridDbscan::place_points() {
  const std::size_t pixels_n = stride_ * (height_ + 2 * margin_) + kNeighbourPadding;
  x_m_.resize(pixels_n);
  y_m_.resize(pixels_n);
  z_m_.assign(pixels_n, kNowhere_m);
  point_at_.resize(pixels_n);
  places_.resize(cloud_.size());
  std::vector<std::size_t> first_mask{0};  // of each row
  for (const std::size_t taps_n : taps_n_) {
    first_mask.push_back(first_mask.back() + words_of(taps_n) * mask_stride_);
  }
  masks_.resize(first_mask.back());
  for (std::size_t i = 0; i < cloud_.size(); ++i) {
    const std::size_t row = cloud_.cells[i] / width_;
    const std::size_t column = cloud_.cells[i] - row * width_;
    const std::size_t pixel = (row + margin_) * stride_ + column + margin_;
    x_m_[pixel] = cloud_.points_m[i].x();
    y_m_[pixel] = cloud_.points_m[i].y();
    z_m_[pixel] = cloud_.points_m[i].z();
    point_at_[pixel] = static_cast<std::uint32_t>(i);
    places_[i] = {static_cast<std::uint32_t>(pixel), static_cast<std::uint32_t>(row),
                  static_cast<std::uint32_t>(first_mask[row] + column)};
  }
}

/// Sets the masks to the neighbours among other points, those with these depths. \returns how many
/// each point has.
std::vector<std::int32_t> GridDbscan::mark_all_neighbours(const std::vector<float>& others_z_m) {
  std::vector<std::ptrdiff_t> offsets;
  for (const Tap& tap : taps_) offsets.push_back(tap.offset);
  std::vector<std::int32_t> result;
  result.reserve(places_.size());
  std::vector<std::int32_t> neighbours_n(width_ + kNeighbourPadding);
  for (std::size_t i = 0; i < places_.size();) {
    const std::size_t row = places_[i].row;
    const std::size_t first = (row + margin_) * stride_ + margin_;
    const std::size_t first_mask = places_[i].mask - (places_[i].pixel - first);
    std::fill(neighbours_n.begin(), neighbours_n.end(), 0);
    for (std::size_t word = 0; word < words_of(taps_n_[row]); ++word) {
      const std::size_t t = word * kWordBits;
      mark_neighbours({&x_m_[first], &y_m_[first], &z_m_[first]},
                      {&x_m_[first], &y_m_[first], &others_z_m[first]}, width_, &offsets[t],
                      std::min(kWordBits, taps_n_[row] - t), eps2_m2_,
                      &masks_[first_mask + word * mask_stride_], neighbours_n.data());
    }
    for (; i < places_.size() && places_[i].row == row; ++i) {
      result.push_back(neighbours_n[places_[i].pixel - first]);
    }
  }
  return result;
}

/// Each core point joins those before it, as connected components of an image are found.
void GridDbscan::connect_core_points(DbscanResult& result) const {
  DisjointSets sets;
  std::vector<std::int32_t> set_at(x_m_.size());
  for (std::uint32_t i = 0; i < places_.size(); ++i) {
    if (!is_core_[i]) continue;
    const Place& here = places_[i];
    std::int32_t own = kNoise;
    for_core(here, taps_before_, [&](const Tap& tap) {
      const std::int32_t other = set_at[here.pixel + tap.offset];
      if (other != own) own = own == kNoise ? sets.find(other) : sets.merge(own, other);
    });
    set_at[here.pixel] = result.labels[i] = own == kNoise ? sets.add() : own;
  }
  renumber(sets, result);
}

DbscanResult GridDbscan::cluster() const {
  DbscanResult result;
  result.labels.assign(cloud_.size(), kNoise);
  result.is_core = is_core_;
  connect_core_points(result);
  assign_border_points(Reach(*this), result);
  return result;
}

void GridDbscan::merge_at_borders(double smoothness_rad, double curvature,
                                  DbscanResult& result) const {
  merge_clusters_at_borders(cloud_, Reach(*this), smoothness_rad, curvature, result);
}

}  // namespace graspd::perception
