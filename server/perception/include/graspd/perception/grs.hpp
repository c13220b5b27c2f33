#pragma once

#include <span>
#include <vector>

#include "graspd/perception/parameters.hpp"
#include "graspd/perception/pile_graph.hpp"
#include "graspd/perception/placed_part.hpp"
#include "graspd/types/answer.hpp"

/// Grasp Risk Score (the paper, III-D.1): GRS(i) = (α·P_self(i) + β·P_grasp(i))·P_system(i), and
/// what we add to it: P_system by the pile graph, and the registration's confidence as a factor.
/// GRS.md gives the equations, how we read them, and what was measured.
namespace graspd::perception {

/// P_self = k₁·z + k₂·sin θ (eq. 7); z the barycentre's height above the floor, θ ∈ [0, π/2] the
/// principal axis' inclination from the horizontal plane.
double p_self(double height_m, double inclination_rad, const GrsParameters& parameters);

/// Inclination of an axis from the horizontal plane, in [0, π/2].
double inclination_rad(const Eigen::Vector3d& axis);

/// P_grasp of one part.
struct PGrasp {
  double value_m2 = 0;
  std::vector<std::uint32_t> neighbours;  ///< indices, nearest first
};
/// P_grasp = (1/K)·Σ over the K nearest other centroids of the squared distance (eq. 8). Neighbours
/// that do not exist count as at `isolation_distance_m`.
PGrasp p_grasp(std::size_t target, std::span<const Eigen::Vector3d> centroids_m,
               const GrsParameters& parameters);

/// P_system of one part, by the count.
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

/// P_system by the pile graph: 1 where nothing rests on the part or lies over it, and less with
/// everything that does.
double p_system_support(double load, double cover);

/// All terms of every part. Indices stand where the answer has ids: the caller's ids are the
/// indices. Only the terms of the P_system that is chosen are filled in.
/// \param graph of the same parts.
std::vector<GrsTerms> grasp_risk_scores(std::span<const PlacedPart> parts, const PileGraph& graph,
                                        const GrsParameters& parameters);

/// Whether `a` is to be grasped before `b`. The paper's text maximises GRS, its equation minimises
/// it; `descending` is the text. Where P_system makes scores equal, α·P_self + β·P_grasp decides.
bool ranks_before(const GrsTerms& a, const GrsTerms& b, const GrsParameters& parameters);

}  // namespace graspd::perception
