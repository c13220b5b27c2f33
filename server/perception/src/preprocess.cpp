#include "graspd/perception/preprocess.hpp"

#include <pcl/features/normal_3d.h>
#include <pcl/search/kdtree.h>

#include <algorithm>
#include <cmath>

#include "filtered.hpp"
#include "graspd/types/camera_model.hpp"
#include "pcl_cloud.hpp"

namespace graspd::perception {
namespace {

/// A floor that was found this far from where the request says the bin's is, is not the bin's.
constexpr double kFloorMismatch_m = 0.03;
constexpr double kFillCell_m = 0.005;
constexpr double kCropDiameters = 2;

/// How full the bin is: the mean over cells of the floor that are seen of the height there.
double fill_level(const Cloud& cloud, const Workspace& workspace) {
  const Eigen::Isometry3f T_workspace_camera = workspace.T_camera_workspace.inverse().cast<float>();
  const auto cells_x = static_cast<int>(std::ceil(workspace.size_m.x() / kFillCell_m));
  const auto cells_y = static_cast<int>(std::ceil(workspace.size_m.y() / kFillCell_m));
  std::vector<float> top_m(static_cast<std::size_t>(cells_x) * cells_y, -1);
  for (const auto& p_camera : cloud.points_m) {
    const Eigen::Vector3f p = T_workspace_camera * p_camera;
    const auto cell = [](float p_m, double size_m) {
      return static_cast<int>((p_m + size_m / 2) / kFillCell_m);
    };
    const int x = std::clamp(cell(p.x(), workspace.size_m.x()), 0, cells_x - 1);
    const int y = std::clamp(cell(p.y(), workspace.size_m.y()), 0, cells_y - 1);
    float& top = top_m[static_cast<std::size_t>(y) * cells_x + x];
    top = std::max(top, std::max(p.z(), 0.0f));
  }
  double sum_m = 0;
  int seen_n = 0;
  for (const float top : top_m) {
    if (top < 0) continue;
    sum_m += top;
    ++seen_n;
  }
  return seen_n == 0 ? 0 : std::min(1.0, sum_m / seen_n / workspace.size_m.z());
}

Plane plane_of_floor(const Eigen::Isometry3d& T_camera_floor) {
  const Eigen::Vector3d up = T_camera_floor.linear().col(2);
  return {up.cast<float>(), static_cast<float>(-up.dot(T_camera_floor.translation()))};
}

/// A frame on the plane below the cloud's centroid, z up, x as near to the camera's as can be.
Eigen::Isometry3d frame_on(const Plane& plane, const Cloud& cloud) {
  Eigen::Vector3f centroid = Eigen::Vector3f::Zero();
  for (const auto& p : cloud.points_m) centroid += p;
  centroid /= static_cast<float>(std::max<std::size_t>(cloud.size(), 1));
  const Eigen::Vector3d z = plane.normal.cast<double>();
  const Eigen::Vector3d x =
      (Eigen::Vector3d::UnitX() - z * z.dot(Eigen::Vector3d::UnitX())).normalized();
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  T.linear() << x, z.cross(x), z;
  T.translation() = (centroid - plane.normal * plane.height_m(centroid)).cast<double>();
  return T;
}

/// The plane square to the optical axis through the deepest point: where there is no floor.
Plane deepest_plane(const Cloud& cloud) {
  float deepest_m = 0;
  for (const auto& p : cloud.points_m) deepest_m = std::max(deepest_m, p.z());
  return {-Eigen::Vector3f::UnitZ(), deepest_m};
}

/// Passthrough, voxel grid and plane removal where the request says where to look.
void preprocess_known(const Cloud& frame_cloud, const Workspace& workspace, bool has_bin,
                      const PreprocessParameters& parameters, Scene& scene) {
  const Cloud inside = passthrough(frame_cloud, workspace);
  scene.funnel.after_passthrough_n = static_cast<std::uint32_t>(inside.size());
  if (has_bin && !inside.empty()) scene.fill_level = fill_level(inside, workspace);
  const Cloud thinned = voxel_grid(inside, parameters.voxel_m);
  scene.funnel.after_voxel_grid_n = static_cast<std::uint32_t>(thinned.size());

  scene.T_camera_floor = workspace.T_camera_workspace;
  const Plane stated = plane_of_floor(scene.T_camera_floor);
  std::optional<Plane> floor = find_floor(thinned, stated.normal, parameters);
  if (floor && has_bin) {
    const double error_m = floor->height_m(scene.T_camera_floor.translation().cast<float>());
    if (std::abs(error_m) > kFloorMismatch_m) floor.reset();
  }
  if (!floor && has_bin) floor = stated;
  scene.has_floor = floor.has_value();
  scene.cloud = floor ? above_plane(thinned, *floor, workspace.size_m.z(), parameters) : thinned;
}

/// The same where it does not: the floor is the plane that is found, and the part's size says how
/// far above and beside it parts are looked for.
void preprocess_unknown(const Cloud& frame_cloud, double part_diameter_m,
                        const PreprocessParameters& parameters, Scene& scene) {
  scene.funnel.after_passthrough_n = static_cast<std::uint32_t>(frame_cloud.size());
  const Cloud thinned = voxel_grid(frame_cloud, parameters.voxel_m);
  scene.funnel.after_voxel_grid_n = static_cast<std::uint32_t>(thinned.size());
  const auto floor = find_floor(thinned, std::nullopt, parameters);
  scene.has_floor = floor.has_value();
  if (floor) {
    const Cloud above = above_plane(thinned, *floor, kCropDiameters * part_diameter_m, parameters);
    scene.cloud = over_floor(above, thinned, *floor, parameters);
    scene.T_camera_floor = frame_on(*floor, scene.cloud);
  } else {
    scene.warnings.push_back(
        "no floor found and no bin given: heights count from the deepest point");
    scene.cloud = thinned;
    scene.T_camera_floor = frame_on(deepest_plane(thinned), thinned);
  }
}

}  // namespace

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

std::optional<Workspace> requested_workspace(const PlanRequest& request,
                                             const PreprocessParameters& parameters) {
  const Eigen::Isometry3d T_camera_base = request.T_base_camera.inverse();
  if (request.bin) {
    Workspace workspace{T_camera_base * request.bin->T_base_bin, request.bin->inner_size_m};
    workspace.size_m.head<2>().array() -= 2 * parameters.wall_margin_m;
    workspace.size_m = workspace.size_m.cwiseMax(0);
    return workspace;
  }
  if (request.crop_box) {
    Workspace workspace{T_camera_base * request.crop_box->T_base_box, request.crop_box->size_m};
    workspace.T_camera_workspace.translate(
        Eigen::Vector3d(0, 0, -request.crop_box->size_m.z() / 2));
    return workspace;
  }
  return std::nullopt;
}

Cloud passthrough(const Cloud& cloud, const Workspace& workspace) {
  const Eigen::Isometry3f T_workspace_camera = workspace.T_camera_workspace.inverse().cast<float>();
  const Eigen::Vector3f half_m = (workspace.size_m / 2).cast<float>();
  const auto height_m = static_cast<float>(workspace.size_m.z());
  return filtered(cloud, [&](const Eigen::Vector3f& p_camera) {
    const Eigen::Vector3f p = T_workspace_camera * p_camera;
    // Below the floor by noise or bowing is still the floor.
    return std::abs(p.x()) <= half_m.x() && std::abs(p.y()) <= half_m.y() && p.z() <= height_m &&
           p.z() >= -static_cast<float>(kFloorMismatch_m);
  });
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
  Scene scene;
  scene.funnel.pixels_n = static_cast<std::uint32_t>(frame.depth.size());
  scene.funnel.readings_n = static_cast<std::uint32_t>(
      frame.depth.size() -
      static_cast<std::size_t>(std::count(frame.depth.begin(), frame.depth.end(), 0)));
  const Cloud frame_cloud = unproject(frame, parameters);
  if (const auto workspace = requested_workspace(request, parameters)) {
    preprocess_known(frame_cloud, *workspace, request.bin.has_value(), parameters, scene);
  } else {
    preprocess_unknown(frame_cloud, part_diameter_m, parameters, scene);
  }
  scene.funnel.after_plane_n = static_cast<std::uint32_t>(scene.cloud.size());
  estimate_normals(scene.cloud, parameters);
  return scene;
}

}  // namespace graspd::perception
