#pragma once

#include <Eigen/Geometry>
#include <optional>
#include <span>
#include <vector>

#include "graspd/perception/collision_kernel.hpp"
#include "graspd/perception/depth_grid.hpp"
#include "graspd/perception/grs.hpp"
#include "graspd/perception/parameters.hpp"
#include "graspd/perception/scene.hpp"
#include "graspd/perception/silhouette.hpp"
#include "graspd/types/request.hpp"

namespace graspd::perception {

/// What the camera knows to be free: along each pixel's ray, everything up to its reading. Beyond,
/// there is matter, or something that nobody has seen, which counts as occupied.
///
/// Where there is no reading, nothing along the ray is known. Up to `hole_px` from the rim of a
/// hole the nearest reading beside it stands for it: the sensor loses the pixels at edges. Farther
/// in, or beyond the image, the ray counts as free only until it enters the space where parts may
/// lie.
///
/// The bin's walls are known, and judged by where they are. In the image they are smeared too, and
/// would keep the gripper away from them: a reading on a wall leaves its ray free, unless the wall
/// hides some of the bin's inside.
///
/// The part that is to be grasped is taken out of the image. Its own silhouette, smeared by a pixel
/// or two, and the shadow right behind it would forbid every grasp, since that is where the jaws
/// belong; and its model is a better judge of where it is. What is seen beside it goes on behind
/// it: a neighbour's reading forbids the shadow too. What lies in front of its model is not its own
/// and stays.
///
/// Of floor and found parts it is known where they are, and a reading may be too near by
/// `cloud_tolerance_m`. What is neither is a part that was not found: nothing but its readings
/// keeps the gripper away from it. They may be too near by `unexplained_tolerance_m`, and the part
/// may reach `edge_px` beyond them, since at its edge the camera sees what lies behind.
class FreeSpace {
 public:
  /// \param scene with what is seen. \param parts that were found. \param bin in the floor's frame.
  FreeSpace(const Scene& scene, std::span<const PlacedPart> parts, const std::optional<Bin>& bin,
            const CollisionParameters& parameters);

  /// Takes this part out of the image, and puts back the one that was out.
  void take_out(const PlacedPart& target);

  /// Whether all of the box is known to be free. What the camera does not look at, since no part
  /// can lie there, is none of its business.
  bool is_free(const Eigen::AlignedBox3d& box_grasp_m,
               const Eigen::Isometry3d& T_floor_grasp) const;

 private:
  struct Cell {
    std::size_t index;
    float value;
  };

  std::size_t index(int u, int v) const {
    return static_cast<std::size_t>(v) * static_cast<std::size_t>(width_px_) +
           static_cast<std::size_t>(u);
  }
  void place(const DepthGrid& seen, const Scene& scene);
  void take_out_walls(const Bin& bin, const Eigen::AlignedBox3d& workspace_m);
  void fill_unseen(const Scene& scene);
  /// The cells of what is seen in the workspace and is neither floor nor found part.
  std::vector<Cell> unexplained(std::span<const PlacedPart> parts, const Scene& scene);
  /// Makes these nearer and wider.
  void keep_from_unexplained(std::span<const PlacedPart> parts, const Scene& scene);
  /// \param see called with each cell of the part's silhouette, smeared by `edge_px`, in which
  ///     nothing is seen in front of the part.
  template <class See>
  void for_cells_of(const PlacedPart& part, const See& see);
  void find_tile_minima();
  /// Until the cell is filled, it holds nothing.
  void open(std::size_t cell);
  /// Gives the open cells what is beside them, the nearest of it, from the rim inwards in at most
  /// `steps_n` steps. Then none is open.
  void fill_from_rim(int steps_n);
  Eigen::Vector3d ray(int u, int v) const;
  FreeDepth for_kernel() const;

  CollisionParameters parameters_;
  Eigen::Isometry3d T_camera_floor_;
  int width_px_ = 0, height_px_ = 0;
  float fx_px_ = 0, fy_px_ = 0, cx_px_ = 0, cy_px_ = 0;
  std::vector<float> free_m_, tile_free_m_;

  // Kept from part to part, to take no memory for each.
  Silhouette silhouette_;
  std::vector<std::uint8_t> is_open_;  ///< of each cell: whether it is to be filled from beside
  std::vector<float> covered_m_;       ///< of each open cell: what it held
  std::vector<std::size_t> open_, rim_;
  std::vector<Cell> filled_, taken_;
};

}  // namespace graspd::perception
