#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "graspd/perception/cloud.hpp"
#include "graspd/perception/dbscan.hpp"

namespace graspd::perception {

/// DBSCAN with the paper's merging at border points, on an organised cloud. The points within Eps
/// of a point lie in a window of pixels that its own depth bounds, so that the image takes the
/// place of the tree, and what is known of a neighbourhood are a few bits: in which pixels of the
/// window a core point of it is. The results are those of `dbscan` and `merge_at_borders`, to the
/// label.
class GridDbscan {
 public:
  /// Finds the core points.
  /// \param cloud organised, with normals and curvatures where `merge_at_borders` is called; must
  /// outlive this.
  GridDbscan(const Cloud& cloud, float eps_m, int min_points_n);

  /// As `dbscan`, of the paper's Definition 4.
  DbscanResult cluster() const;
  /// As the function of that name: lines 6 to 8 of the paper's Algorithm 1.
  void merge_at_borders(double smoothness_rad, double curvature, DbscanResult& result) const;

 private:
  class Reach;
  /// A pixel of the window.
  struct Tap {
    float distance2;  ///< of the two pixels' rays, at z = 1
    std::ptrdiff_t offset;
  };
  /// Where a point is.
  struct Place {
    std::uint32_t pixel;
    std::uint32_t row;
    std::uint32_t mask;  ///< the first word of its mask
  };

  void make_window(const std::vector<float>& row_reach2);
  void place_points();
  std::vector<std::int32_t> mark_all_neighbours(const std::vector<float>& others_z_m);
  template <class Visit>
  void for_core(const Place& here, const std::vector<std::uint32_t>& among, Visit visit) const;
  void connect_core_points(DbscanResult& result) const;
  float distance2_m2(std::size_t a, std::size_t b) const {
    const float x = x_m_[a] - x_m_[b];
    const float y = y_m_[a] - y_m_[b];
    const float z = z_m_[a] - z_m_[b];
    // As Eigen's squaredNorm adds them up, so that no rounding differs from elsewhere.
    return x * x + (y * y + z * z);
  }

  const Cloud& cloud_;
  float eps2_m2_;
  std::vector<bool> is_core_;
  /// The image with a margin as wide as the widest window: no tap leaves it.
  std::size_t width_ = 0, height_ = 0, margin_ = 0, stride_ = 0, mask_stride_ = 0;
  std::vector<float> x_m_, y_m_, z_m_;   ///< by pixel; z is NaN, near nothing, where no point is
  std::vector<std::uint32_t> point_at_;  ///< by pixel, where one is
  std::vector<Place> places_;            ///< by point
  std::vector<Tap> taps_;                ///< nearest first
  std::vector<std::uint32_t> every_tap_, taps_before_;  ///< masks
  std::vector<std::size_t> taps_n_;  ///< by row: how many taps its points' windows have
  /// Bit t of a point's mask: whether a neighbour and core point is at tap t. Rows one after the
  /// other, in these one word for all columns after the other.
  std::vector<std::uint32_t> masks_;
};

}  // namespace graspd::perception
