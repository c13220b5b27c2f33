#pragma once

#include <Eigen/Geometry>
#include <span>
#include <vector>

#include "graspd/parts/part.hpp"
#include "graspd/perception/parameters.hpp"
#include "graspd/types/answer.hpp"

/// Grasp Risk Score (the paper, III-D.1): GRS(i) = (α·P_self(i) + β·P_grasp(i))·P_system(i).
namespace graspd::perception {

/// A part where it lies. The frame is the bin's: z up, origin on the floor.
struct PlacedPart {
  const parts::Part* part = nullptr;
  Eigen::Isometry3d T_floor_part = Eigen::Isometry3d::Identity();

  Eigen::Vector3d barycentre_m() const { return T_floor_part * part->barycentre_m; }
  /// Of the longest principal axis, either way round.
  Eigen::Vector3d principal_axis() const {
    return T_floor_part.linear() * part->principal_axes.col(0);
  }
};

/// P_self = k₁·z + k₂·sin θ (eq. 7); z the barycentre's height above the floor, θ ∈ [0, π/2] the
/// principal axis' inclination from the horizontal plane.
double p_self(double height_m, double inclination_rad, const GrsParameters& parameters);

/// Inclination of an axis from the horizontal plane, in [0, π/2].
double inclination_rad(const Eigen::Vector3d& axis);

struct PGrasp {
  double value_m2 = 0;
  std::vector<std::uint32_t> neighbours;  ///< indices, nearest first
};
/// P_grasp = (1/K)·Σ over the K nearest other centroids of the squared distance (eq. 8). Neighbours
/// that do not exist count as at `isolation_distance_m`.
PGrasp p_grasp(std::size_t target, std::span<const Eigen::Vector3d> centroids_m,
               const GrsParameters& parameters);

struct PSystemCount {
  double value = 1;  ///< 0 where the count exceeds the threshold
  std::uint32_t points_n = 0;
  std::vector<std::uint32_t> others;  ///< indices of the parts that share points
};
/// P_system by the paper's count (eq. 9): how many template points of the target coincide, within
/// `overlap_distance_m`, with template points of another part. Templates stand in for the points
/// that were seen, so that hidden contact counts.
PSystemCount p_system_count(std::size_t target, std::span<const PlacedPart> parts,
                            const GrsParameters& parameters);

/// All terms of every part. Indices stand where the answer has ids: the caller's ids are the
/// indices.
std::vector<GrsTerms> grasp_risk_scores(std::span<const PlacedPart> parts,
                                        const GrsParameters& parameters);

/// Whether `a` is to be grasped before `b`. The paper's text maximises GRS, its equation minimises
/// it; `descending` is the text. Where P_system makes scores equal, α·P_self + β·P_grasp decides.
bool ranks_before(const GrsTerms& a, const GrsTerms& b, const GrsParameters& parameters);

}  // namespace graspd::perception
