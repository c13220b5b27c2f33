#include <pcl/console/print.h>
#include <pcl/features/fpfh.h>
#include <pcl/registration/ia_ransac.h>
#include <pcl/registration/icp.h>
#include <pcl/registration/ndt.h>
#include <pcl/search/kdtree.h>

#include <cmath>
#include <cstdlib>
#include <map>
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

/// How often a surface point that faces one of `directions` is seen from there: not where the part
/// itself stands in between. A coarse z-buffer of the points decides.
std::vector<double> shares_seen(const parts::Part& part,
                                std::span<const Eigen::Vector3f> directions) {
  constexpr float kCell_m = 0.003f;
  constexpr float kBehind_m = 0.003f;
  std::vector<int> facing_n(part.surface.size());
  std::vector<int> seen_n(part.surface.size());
  for (const Eigen::Vector3f& towards : directions) {
    const Eigen::Vector3f right = towards.unitOrthogonal();
    const Eigen::Vector3f down = towards.cross(right);
    const auto cell_of = [&](const Eigen::Vector3f& p) {
      return std::pair(std::lround(p.dot(right) / kCell_m), std::lround(p.dot(down) / kCell_m));
    };
    std::map<std::pair<long, long>, float> nearest_m;
    for (const auto& point : part.surface) {
      const float height_m = point.position_m.dot(towards);
      const auto [entry, is_new] = nearest_m.emplace(cell_of(point.position_m), height_m);
      if (!is_new) entry->second = std::max(entry->second, height_m);
    }
    for (std::size_t i = 0; i < part.surface.size(); ++i) {
      const auto& point = part.surface[i];
      if (point.normal.dot(towards) < 0.3f) continue;
      ++facing_n[i];
      seen_n[i] += point.position_m.dot(towards) > nearest_m[cell_of(point.position_m)] - kBehind_m;
    }
  }
  std::vector<double> shares;
  for (std::size_t i = 0; i < facing_n.size(); ++i) {
    shares.push_back(facing_n[i] == 0 ? 0 : static_cast<double>(seen_n[i]) / facing_n[i]);
  }
  return shares;
}

/// The points that are seen from at least half of the directions they face: the outside. The bore
/// of a pipe lies a wall's thickness below and would draw the points of the outside towards it.
Cloud outside_of(const parts::Part& part) {
  constexpr int kDirections = 64;
  const auto directions = parts::spread_directions(kDirections);
  const std::vector<double> shares = shares_seen(part, directions);
  Cloud outside;
  for (std::size_t i = 0; i < shares.size(); ++i) {
    if (shares[i] >= 0.5) outside.points_m.push_back(part.surface[i].position_m);
  }
  return outside;
}

Templates make_templates(std::span<const parts::Part* const> parts) {
  auto templates = std::make_shared<std::vector<Template>>();
  for (const parts::Part* part : parts) {
    Template& made = templates->emplace_back();
    made.cloud = voxel_grid(outside_of(*part), kTemplateSpacing_m);
    made.points = to_pcl(made.cloud);
    made.tree->setInputCloud(made.points);
    made.frame = principal_frame(made.cloud.points_m);
  }
  return templates;
}

Eigen::Isometry3d pose_of(const Eigen::Matrix4f& T_part_camera) {
  Eigen::Isometry3d T;
  T.matrix() = T_part_camera.cast<double>();
  // Thousands of float products drift: back to the nearest rotation.
  T.linear() = Eigen::Quaterniond(T.linear()).normalized().toRotationMatrix();
  return T.inverse();
}

/// Aligns the segment, which shows one side only, to the whole template, so that every point of the
/// segment finds its partner. A fresh object per call: PCL's keeps state between calls.
std::optional<Eigen::Isometry3d> icp(const Points::Ptr& segment, const Template& model,
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
  return pose_of(registration.getFinalTransformation());
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

/// ICP from each PCA alignment, after `coarse` has made it better.
template <class Coarse>
std::vector<Eigen::Isometry3d> from_pca_alignments(const Cloud& segment, const Template& model,
                                                   const RegistrationParameters& parameters,
                                                   Coarse coarse) {
  std::vector<Eigen::Isometry3d> poses;
  if (segment.size() < kMinSegmentPoints) return poses;
  const Points::Ptr points = to_pcl(segment);
  for (const Eigen::Matrix4f& start : pca_alignments(segment, model)) {
    if (const auto pose = icp(points, model, coarse(points, start), parameters)) {
      poses.push_back(*pose);
    }
  }
  return poses;
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
    return from_pca_alignments(
        segment, (*templates)[part], parameters,
        [](const Points::Ptr&, const Eigen::Matrix4f& start) { return start; });
  };
}

RegistrationMethod ndt_icp(std::span<const parts::Part* const> parts,
                           const RegistrationParameters& parameters) {
  return [templates = make_templates(parts), parameters](const Cloud& segment, std::size_t part) {
    const Template& model = (*templates)[part];
    return from_pca_alignments(segment, model, parameters,
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
                                           std::size_t part) -> std::vector<Eigen::Isometry3d> {
    if (segment.size() < kMinSegmentPoints) return {};
    const Points::Ptr points = to_pcl(segment);
    const Eigen::Matrix4f coarse = sac_ia(points, fpfh(segment, points, parameters),
                                          (*templates)[part], (*features)[part], parameters);
    const auto pose = icp(points, (*templates)[part], coarse, parameters);
    if (!pose) return {};
    return {*pose};
  };
}

}  // namespace graspd::perception
