#pragma once

#include <Eigen/Geometry>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "graspd/parts/part.hpp"
#include "graspd/perception/cloud.hpp"
#include "graspd/perception/evidence.hpp"
#include "graspd/perception/is_late.hpp"
#include "graspd/perception/parameters.hpp"
#include "graspd/perception/preprocess.hpp"
#include "graspd/perception/refusal.hpp"

/// From segments to posed parts.
namespace graspd::perception {

/// Mean and principal axes of a point set (the paper, eq. 3 and 4).
struct PrincipalFrame {
  Eigen::Vector3d centroid_m = Eigen::Vector3d::Zero();
  Eigen::Matrix3d axes = Eigen::Matrix3d::Identity();  ///< columns, largest variance first
  Eigen::Vector3d variances_m2 = Eigen::Vector3d::Zero();
};
/// \param points_m at least one; the axes are right-handed.
PrincipalFrame principal_frame(std::span<const Eigen::Vector3f> points_m);

/// A registration method, ready for a list of parts: the poses T_camera_part that part `part` of
/// that list may have in one segment, or none. May be called from several threads.
using RegistrationMethod =
    std::function<std::vector<Eigen::Isometry3d>(const Cloud& segment, std::size_t part)>;

/// The paper's: PCA alignment of segment and model, then point-to-point ICP minimising Σ‖p − Tq‖²,
/// from each of the four sign choices that PCA leaves open.
RegistrationMethod pca_icp(std::span<const parts::Part* const> parts,
                           const RegistrationParameters& parameters);
/// PCL's SAC-IA over FPFH features, then ICP.
RegistrationMethod sac_ia_icp(std::span<const parts::Part* const> parts,
                              const RegistrationParameters& parameters);
/// PCL's NDT from the four PCA alignments, then ICP.
RegistrationMethod ndt_icp(std::span<const parts::Part* const> parts,
                           const RegistrationParameters& parameters);

/// \throws std::invalid_argument for a method that this build does not have, or kServerDefault.
RegistrationMethod registration_method(Registration name, std::span<const parts::Part* const> parts,
                                       const RegistrationParameters& parameters);

/// A part where the frame says it lies.
struct RegisteredPart {
  const parts::Part* part = nullptr;
  Eigen::Isometry3d T_camera_part = Eigen::Isometry3d::Identity();
  Evidence evidence;
  Eigen::Vector3d p_camera_segment_centroid_m = Eigen::Vector3d::Zero();
};

/// What was found in a frame, and what was not.
struct RegistrationResult {
  std::vector<RegisteredPart> parts;  ///< best score first
  std::uint32_t hypotheses_n = 0;     ///< poses tried, the roughest included
  std::uint32_t rejected_score_n = 0;
  std::optional<Refusal> refusal;  ///< of the refused pose that the frame supports best
};

/// Registers every part in every segment, keeps the pose that the depth image supports best, drops
/// poses below `min_score`, poses that reach through the floor by more than `max_below_floor_m` and
/// poses of a place that is taken by a better one.
/// Works on the segments in parallel, within the caller's TBB arena. Once it is late, what was
/// found so far.
RegistrationResult register_segments(const DepthFrame& frame, const Scene& scene,
                                     std::span<const Indices> segments,
                                     std::span<const parts::Part* const> parts,
                                     const RegistrationParameters& parameters,
                                     const IsLate& is_late = never_late);

}  // namespace graspd::perception
