#include "graspd/perception/preprocess.hpp"

#include <pcl/features/normal_3d.h>
#include <pcl/search/kdtree.h>

#include <algorithm>
#include <cmath>

#include "graspd/perception/organised.hpp"
#include "graspd/types/camera_model.hpp"
#include "pcl_cloud.hpp"

namespace graspd::perception {

Cloud unproject(const DepthFrame& frame, const PreprocessParameters& parameters) {
  const CameraIntrinsics& camera = frame.camera;
  Cloud cloud;
  cloud.points_m.reserve(frame.depth.size());
  for (int v = 0; v < camera.height_px; ++v) {
    for (int u = 0; u < camera.width_px; ++u) {
      const double z_m = frame.at(u, v) * frame.depth_scale_m;
      if (z_m < parameters.min_depth_m || z_m > parameters.max_depth_m) continue;
      cloud.points_m.push_back((ray_through(camera, u, v) * z_m).cast<float>());
    }
  }
  return cloud;
}

Cloud voxel_grid(const Cloud& cloud, double voxel_m) {
  constexpr int kBits = 21;
  constexpr auto kOffset = std::int64_t{1} << (kBits - 1);
  struct Entry {
    std::uint64_t voxel;
    std::uint32_t point;
    bool operator<(const Entry& other) const {
      return voxel != other.voxel ? voxel < other.voxel : point < other.point;
    }
  };
  std::vector<Entry> entries(cloud.size());
  for (std::uint32_t i = 0; i < entries.size(); ++i) {
    std::uint64_t voxel = 0;
    for (int axis = 0; axis < 3; ++axis) {
      const auto cell =
          static_cast<std::int64_t>(std::floor(cloud.points_m[i][axis] / voxel_m)) + kOffset;
      voxel = voxel << kBits | static_cast<std::uint64_t>(cell);
    }
    entries[i] = {voxel, i};
  }
  std::sort(entries.begin(), entries.end());
  Cloud result;
  for (std::size_t begin = 0; begin < entries.size();) {
    Eigen::Vector3f sum = Eigen::Vector3f::Zero();
    std::size_t end = begin;
    for (; end < entries.size() && entries[end].voxel == entries[begin].voxel; ++end) {
      sum += cloud.points_m[entries[end].point];
    }
    result.points_m.push_back(sum / static_cast<float>(end - begin));
    begin = end;
  }
  return result;
}

void estimate_normals(Cloud& cloud, const PreprocessParameters& parameters) {
  if (cloud.empty()) return;
  const auto points = to_pcl(cloud);
  pcl::NormalEstimation<pcl::PointXYZ, pcl::Normal> estimation;
  estimation.setInputCloud(points);
  const pcl::search::KdTree<pcl::PointXYZ>::Ptr tree(new pcl::search::KdTree<pcl::PointXYZ>);
  estimation.setSearchMethod(tree);
  estimation.setKSearch(parameters.normal_neighbours_n);
  pcl::PointCloud<pcl::Normal> normals;
  estimation.compute(normals);
  cloud.normals.resize(cloud.size());
  cloud.curvatures.resize(cloud.size());
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    const Eigen::Vector3f normal = normals[i].getNormalVector3fMap();
    const bool fitted = normal.allFinite();
    cloud.normals[i] = fitted ? normal : Eigen::Vector3f(-cloud.points_m[i].normalized());
    cloud.curvatures[i] = fitted ? normals[i].curvature : 0;
  }
}

Scene preprocess(const DepthFrame& frame, const PlanRequest& request, double part_diameter_m,
                 const PreprocessParameters& parameters) {
  Scene scene = cut_out_parts(
      frame, unproject(frame, parameters), request, part_diameter_m, parameters,
      {[&](const Cloud& cloud) { return voxel_grid(cloud, parameters.voxel_m); }, find_floor});
  estimate_normals(scene.cloud, parameters);
  return scene;
}

Scene prepare_readings(const DepthFrame& frame, const PlanRequest& request, double part_diameter_m,
                       const Parameters& parameters) {
  const auto prepare =
      parameters.segmentation.method == Segmentation::kGridDbscan ? organised_readings : preprocess;
  return prepare(frame, request, part_diameter_m, parameters.preprocess);
}

Scene prepare_scene(const DepthFrame& frame, const PlanRequest& request, double part_diameter_m,
                    const Parameters& parameters) {
  Scene scene = prepare_readings(frame, request, part_diameter_m, parameters);
  if (scene.grid) add_normals(scene);
  return scene;
}

}  // namespace graspd::perception
