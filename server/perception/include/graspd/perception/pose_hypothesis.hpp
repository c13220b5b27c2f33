#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <vector>

#include "graspd/parts/part.hpp"
#include "graspd/perception/confidence.hpp"
#include "graspd/perception/depth_grid.hpp"
#include "graspd/perception/evidence.hpp"
#include "graspd/perception/parameters.hpp"
#include "graspd/perception/refusal.hpp"

/// A pose that may be right, and what the depth image says of it: projective verification and
/// projective ICP. Nothing here searches for neighbours: a model point is compared with the reading
/// at the pixel that it projects to.
namespace graspd::perception {

/// A pose that one of the parts may have. Camera's optical frame.
struct PoseHypothesis {
  std::uint32_t part = 0;  ///< index into the requested parts
  Eigen::Matrix3f R = Eigen::Matrix3f::Identity();
  Eigen::Vector3f t_m = Eigen::Vector3f::Zero();  ///< with R: T_camera_part
  /// Of the part's largest view, the share that is explained less what is refuted, in [−∞, 1]. So
  /// that a pose which hides most of its part behind itself does not win by being right about the
  /// rest.
  float score = 0;
  /// The same share of what this view shows, so that a view of little is not judged by that.
  float fit = 0;
  /// How probable it is that the pose is right. `score_finally` sets it as if the bin held nothing
  /// else, `weigh_in_bin` then as it is in this bin.
  float confidence = 0;
  PoseCounts counts;

  Eigen::Vector3f in_camera(const Eigen::Vector3f& p_part_m) const { return R * p_part_m + t_m; }
  Eigen::Isometry3d T_camera_part() const;
  /// Not scored yet.
  static PoseHypothesis of(const Eigen::Isometry3d& T_camera_part, std::uint32_t part = 0);
};

/// What its counts say, and its confidence as score.
Evidence evidence_of(const PoseHypothesis& pose);

/// Cells that were met already; clearing costs nothing.
class CellMarks {
 public:
  explicit CellMarks(std::size_t cells_n) : met_at_(cells_n, 0) {}
  void clear() { ++now_; }
  /// \returns whether it is asked for and the cell is new.
  bool add_if(bool asked, std::size_t cell) {
    std::uint32_t& met_at = met_at_[cell];
    const bool is_new = asked & (met_at != now_);
    met_at = asked ? now_ : met_at;
    return is_new;
  }

 private:
  std::vector<std::uint32_t> met_at_;
  std::uint32_t now_ = 1;
};

/// Scores and refines the poses of a list of parts in one image.
class PoseVerifier {
 public:
  /// Enough for a first look: the leading points of a view are spread as far as can be.
  static constexpr std::size_t kCoarsePoints = parts::RegistrationModel::kSpreadPoints;
  /// As many as the view has.
  static constexpr std::size_t kAllPoints = std::numeric_limits<std::size_t>::max();

  /// The arguments must outlive the verifier; the grid may change between calls.
  PoseVerifier(const DepthGrid& grid, std::span<const parts::Part* const> parts,
               const RegistrationParameters& parameters)
      : grid_(grid), parts_(parts), parameters_(parameters) {}

  const parts::Part& part(const PoseHypothesis& pose) const { return *parts_[pose.part]; }
  double tolerance_m() const { return parameters_.inlier_tolerance_m; }
  /// What this camera sees of the part: the view whose direction is nearest.
  const parts::View& view(const PoseHypothesis& pose) const;
  /// In the camera's optical frame.
  Eigen::Vector3f barycentre_m(const PoseHypothesis& pose) const;
  /// The area of the image's surface that the score stands for: what compares different parts.
  float explained_area_m2(const PoseHypothesis& pose) const {
    return pose.score * part(pose).registration.largest_view_m2();
  }

  /// Sets counts and score from up to `points_n` leading points of the view.
  /// \returns false where it stopped early: then there is no score.
  bool score(PoseHypothesis& pose, std::size_t points_n, double tolerance_m,
             const EarlyStop& stop = {}) const;

  /// Projective point-to-plane ICP, one step with Tukey's weights, damped so that a direction
  /// that the image says nothing of stays.
  void icp_step(PoseHypothesis& pose, std::size_t points_n, double tolerance_m) const;

  /// Moves the pose to where the score is best nearby. Silhouettes pull here, of which ICP knows
  /// nothing.
  void search_nearby(PoseHypothesis& pose) const;

  /// From a rough pose to its final place and score. \returns as `score_finally`.
  std::optional<Refusal> refine(PoseHypothesis& pose) const;

  /// As `score` of all points, with the say of normals and small errors; 0 where a rule of
  /// `RegistrationParameters` forbids the pose. \returns the first such rule.
  std::optional<Refusal> score_finally(PoseHypothesis& pose) const;

  /// Of the outline, the share beyond which the same surface goes on.
  float leftover_share(const PoseHypothesis& pose) const;

  /// \param pose with the final score, above 0.
  ConfidenceTerms confidence_terms(const PoseHypothesis& pose, float leftover) const;

  /// Writes the cells whose open readings lie within `tolerance_m` of the pose, each once: those
  /// that its points project to.
  /// \param marks of as many cells as the grid has; working memory.
  /// \param cells room for as many as the view has points. \returns how many there are.
  std::size_t supporting_cells(const PoseHypothesis& pose, double tolerance_m, CellMarks& marks,
                               std::uint32_t* cells) const;

  /// The same with their neighbours.
  std::vector<std::uint32_t> explained_cells(const PoseHypothesis& pose, double tolerance_m,
                                             CellMarks& marks) const;

 private:
  /// The leading points of the pose's view.
  SurfaceSpan seen_surface(const PoseHypothesis& pose, std::size_t most = kAllPoints) const;
  SurfaceSpan seen_surface(const PoseHypothesis& pose, const parts::View& seen,
                           std::size_t most) const;
  std::size_t open_cells(const PoseHypothesis& pose, double tolerance_m,
                         std::span<const std::int32_t> offsets, CellMarks& marks,
                         std::uint32_t* cells) const;
  std::optional<Refusal> refusal(const PoseHypothesis& pose, float leftover) const;
  /// \param support of the points within tolerance, each by its weight.
  void set_score(PoseHypothesis& pose, const parts::View& seen, float support) const;

  const DepthGrid& grid_;
  std::span<const parts::Part* const> parts_;
  const RegistrationParameters& parameters_;
};

}  // namespace graspd::perception
