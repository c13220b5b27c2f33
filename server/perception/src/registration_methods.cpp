#include <pcl/console/print.h>
#include <pcl/features/fpfh.h>
#include <pcl/registration/ia_ransac.h>
#include <pcl/registration/icp.h>
#include <pcl/registration/ndt.h>
#include <pcl/search/kdtree.h>

#include <cstdlib>
#include <memory>
#include <mutex>

#include "graspd/perception/preprocess.hpp"
#include "graspd/perception/registration.hpp"
#include "pcl_cloud.hpp"

namespace graspd::perception {
namespace {

using Points = pcl::PointCloud<pcl::PointXYZ>;
using Features = pcl::PointCloud<pcl::FPFHSignature33>;
using Tree = pcl::search::KdTree<pcl::PointXYZ>;

// A library does not print: PCL would, on every alignment that finds too few partners.
[[maybe_unused]] const bool kPclIsQuiet = [] {
  pcl::console::setVerbosityLevel(pcl::console::L_ALWAYS);
  return true;
}();

constexpr std::size_t kMinSegmentPoints = 10;
constexpr double kTemplateSpacing_m = 0.003;

/// A part's template as PCL wants it, with its search tree built once.
struct Template {
  Cloud cloud;
  Points::Ptr points;
  Tree::Ptr tree{new Tree};
  PrincipalFrame frame;
};
using Templates = std::shared_ptr<const std::vector<Template>>;

Templates make_templates(std::span<const parts::Part* const> parts) {
  auto templates = std::make_shared<std::vector<Template>>();
  for (const parts::Part* part : parts) {
    Template& made = templates->emplace_back();
    Cloud surface;
    for (const auto& point : part->surface) surface.points_m.push_back(point.position_m);
    made.cloud = voxel_grid(surface, kTemplateSpacing_m);
    made.points = to_pcl(made.cloud);
    made.tree->setInputCloud(made.points);
    made.frame = principal_frame(made.cloud.points_m);
  }
  return templates;
}

struct Alignment {
  Eigen::Matrix4f T_part_camera = Eigen::Matrix4f::Identity();
  double residual_m2 = std::numeric_limits<double>::max();  ///< mean of ‖p − Tq‖²
};

/// Aligns the segment, which shows one side only, to the whole template, so that every point of the
/// segment finds its partner. A fresh object per call: PCL's keeps state between calls.
std::optional<Alignment> icp(const Points::Ptr& segment, const Template& model,
                             const Eigen::Matrix4f& T_part_camera,
                             const RegistrationParameters& parameters) {
  pcl::IterativeClosestPoint<pcl::PointXYZ, pcl::PointXYZ> registration;
  registration.setInputSource(segment);
  registration.setInputTarget(model.points);
  registration.setSearchMethodTarget(model.tree, /*force_no_recompute=*/true);
  registration.setMaxCorrespondenceDistance(parameters.icp_max_distance_m);
  registration.setMaximumIterations(parameters.icp_iterations_n);
  registration.setTransformationEpsilon(1e-10);
  Points aligned;
  registration.align(aligned, T_part_camera);
  if (!registration.hasConverged()) return std::nullopt;
  return Alignment{registration.getFinalTransformation(), registration.getFitnessScore()};
}

/// PCA leaves the axes' signs open: the four proper choices.
std::vector<Eigen::Matrix4f> pca_alignments(const Cloud& segment, const Template& model) {
  const PrincipalFrame seen = principal_frame(segment.points_m);
  const Eigen::Vector3d signs[] = {{1, 1, 1}, {1, -1, -1}, {-1, 1, -1}, {-1, -1, 1}};
  std::vector<Eigen::Matrix4f> alignments;
  for (const auto& sign : signs) {
    Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
    T.linear() = model.frame.axes * sign.asDiagonal() * seen.axes.transpose();
    T.translation() = model.frame.centroid_m - T.linear() * seen.centroid_m;
    alignments.push_back(T.matrix().cast<float>());
  }
  return alignments;
}

Eigen::Isometry3d pose_of(const Alignment& alignment) {
  Eigen::Isometry3d T_part_camera;
  T_part_camera.matrix() = alignment.T_part_camera.cast<double>();
  // Thousands of float products drift: back to the nearest rotation.
  T_part_camera.linear() =
      Eigen::Quaterniond(T_part_camera.linear()).normalized().toRotationMatrix();
  return T_part_camera.inverse();
}

/// The best of ICP's results over several starts.
template <class Coarse>
std::optional<Eigen::Isometry3d> best_of_starts(const Cloud& segment, const Template& model,
                                                const RegistrationParameters& parameters,
                                                Coarse coarse) {
  if (segment.size() < kMinSegmentPoints) return std::nullopt;
  const Points::Ptr points = to_pcl(segment);
  Alignment best;
  for (const Eigen::Matrix4f& start : pca_alignments(segment, model)) {
    const auto alignment = icp(points, model, coarse(points, start), parameters);
    if (alignment && alignment->residual_m2 < best.residual_m2) best = *alignment;
  }
  if (best.residual_m2 == std::numeric_limits<double>::max()) return std::nullopt;
  return pose_of(best);
}

Eigen::Matrix4f ndt(const Points::Ptr& segment, const Template& model, const Eigen::Matrix4f& start,
                    const RegistrationParameters& parameters) {
  pcl::NormalDistributionsTransform<pcl::PointXYZ, pcl::PointXYZ> registration;
  registration.setResolution(static_cast<float>(parameters.ndt_resolution_m));
  registration.setStepSize(parameters.ndt_resolution_m / 10);
  registration.setTransformationEpsilon(1e-4);
  registration.setMaximumIterations(35);
  registration.setInputSource(segment);
  registration.setInputTarget(model.points);
  Points aligned;
  registration.align(aligned, start);
  const Eigen::Matrix4f T = registration.getFinalTransformation();
  return T.allFinite() ? T : start;
}

Features::Ptr fpfh(const Cloud& cloud, const Points::Ptr& points,
                   const RegistrationParameters& parameters) {
  pcl::FPFHEstimation<pcl::PointXYZ, pcl::Normal, pcl::FPFHSignature33> estimation;
  estimation.setInputCloud(points);
  estimation.setInputNormals(normals_to_pcl(cloud));
  estimation.setSearchMethod(Tree::Ptr(new Tree));
  estimation.setRadiusSearch(parameters.feature_radius_m);
  Features::Ptr features(new Features);
  estimation.compute(*features);
  return features;
}

/// Voxel centroids lie inside a curved surface: each takes the normal of the nearest surface point.
void take_normals(const parts::Part& part, Cloud& cloud) {
  for (const auto& p : cloud.points_m) {
    const auto nearest = std::min_element(
        part.surface.begin(), part.surface.end(), [&](const auto& a, const auto& b) {
          return (a.position_m - p).squaredNorm() < (b.position_m - p).squaredNorm();
        });
    cloud.normals.push_back(nearest->normal);
    cloud.curvatures.push_back(0);
  }
}

Eigen::Matrix4f sac_ia(const Points::Ptr& segment, const Features::Ptr& segment_features,
                       const Template& model, const Features::Ptr& model_features,
                       const RegistrationParameters& parameters) {
  // PCL draws from rand(), which is one for the whole process: one at a time, seeded alike.
  static std::mutex rand_mutex;
  const std::scoped_lock lock(rand_mutex);
  std::srand(1);  // NOLINT(cert-msc51-cpp)
  pcl::SampleConsensusInitialAlignment<pcl::PointXYZ, pcl::PointXYZ, pcl::FPFHSignature33>
      registration;
  registration.setInputSource(segment);
  registration.setSourceFeatures(segment_features);
  registration.setInputTarget(model.points);
  registration.setTargetFeatures(model_features);
  registration.setSearchMethodTarget(model.tree, /*force_no_recompute=*/true);
  registration.setMinSampleDistance(static_cast<float>(parameters.icp_max_distance_m));
  registration.setMaxCorrespondenceDistance(parameters.icp_max_distance_m);
  registration.setMaximumIterations(parameters.sac_iterations_n);
  Points aligned;
  registration.align(aligned);
  return registration.getFinalTransformation();
}

}  // namespace

RegistrationMethod pca_icp(std::span<const parts::Part* const> parts,
                           const RegistrationParameters& parameters) {
  return [templates = make_templates(parts), parameters](const Cloud& segment, std::size_t part) {
    return best_of_starts(segment, (*templates)[part], parameters,
                          [](const Points::Ptr&, const Eigen::Matrix4f& start) { return start; });
  };
}

RegistrationMethod ndt_icp(std::span<const parts::Part* const> parts,
                           const RegistrationParameters& parameters) {
  return [templates = make_templates(parts), parameters](const Cloud& segment, std::size_t part) {
    const Template& model = (*templates)[part];
    return best_of_starts(segment, model, parameters,
                          [&](const Points::Ptr& points, const Eigen::Matrix4f& start) {
                            return ndt(points, model, start, parameters);
                          });
  };
}

RegistrationMethod sac_ia_icp(std::span<const parts::Part* const> parts,
                              const RegistrationParameters& parameters) {
  const Templates templates = make_templates(parts);
  auto features = std::make_shared<std::vector<Features::Ptr>>();
  for (std::size_t i = 0; i < parts.size(); ++i) {
    Cloud cloud = (*templates)[i].cloud;
    take_normals(*parts[i], cloud);
    features->push_back(fpfh(cloud, (*templates)[i].points, parameters));
  }
  return [templates, features, parameters](const Cloud& segment,
                                           std::size_t part) -> std::optional<Eigen::Isometry3d> {
    if (segment.size() < kMinSegmentPoints) return std::nullopt;
    const Points::Ptr points = to_pcl(segment);
    const Eigen::Matrix4f coarse = sac_ia(points, fpfh(segment, points, parameters),
                                          (*templates)[part], (*features)[part], parameters);
    const auto alignment = icp(points, (*templates)[part], coarse, parameters);
    if (!alignment) return std::nullopt;
    return pose_of(*alignment);
  };
}

}  // namespace graspd::perception
