#include "graspd/perception/scene.hpp"

#include <algorithm>
#include <cmath>

#include "filtered.hpp"

namespace graspd::perception {
namespace {

/// A floor that was found this far from where the request says the bin's is, is not the bin's.
constexpr double kFloorMismatch_m = 0.03;
constexpr double kFillCell_m = 0.005;
constexpr double kCropDiameters = 2;

/// How full the bin is: the mean over cells of the floor that are seen of the mean height there.
/// Cells count alike, however many readings the camera has of each.
double fill_level(const Cloud& cloud, const Workspace& workspace) {
  const Eigen::Isometry3f T_workspace_camera = workspace.T_camera_workspace.inverse().cast<float>();
  const auto cells_x = static_cast<int>(std::ceil(workspace.size_m.x() / kFillCell_m));
  const auto cells_y = static_cast<int>(std::ceil(workspace.size_m.y() / kFillCell_m));
  struct Cell {
    float height_sum_m = 0;
    int points_n = 0;
  };
  std::vector<Cell> cells(static_cast<std::size_t>(cells_x) * cells_y);
  for (const auto& p_camera : cloud.points_m) {
    const Eigen::Vector3f p = T_workspace_camera * p_camera;
    const auto index = [](float p_m, double size_m) {
      return static_cast<int>((p_m + size_m / 2) / kFillCell_m);
    };
    const int x = std::clamp(index(p.x(), workspace.size_m.x()), 0, cells_x - 1);
    const int y = std::clamp(index(p.y(), workspace.size_m.y()), 0, cells_y - 1);
    Cell& cell = cells[static_cast<std::size_t>(y) * cells_x + x];
    cell.height_sum_m += std::max(p.z(), 0.0f);
    ++cell.points_n;
  }
  double sum_m = 0;
  int seen_n = 0;
  for (const Cell& cell : cells) {
    if (cell.points_n == 0) continue;
    sum_m += static_cast<double>(cell.height_sum_m) / cell.points_n;
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

/// Where the request says where to look.
void cut_out_known(const Cloud& readings, const Workspace& workspace, bool has_bin,
                   const PreprocessParameters& parameters, const Sampling& sampling, Scene& scene) {
  Cloud inside = passthrough(readings, workspace);
  scene.funnel.after_passthrough_n = static_cast<std::uint32_t>(inside.size());
  if (has_bin && !inside.empty()) scene.fill_level = fill_level(inside, workspace);
  const Cloud thinned = sampling.thin(std::move(inside));
  scene.funnel.after_voxel_grid_n = static_cast<std::uint32_t>(thinned.size());

  scene.T_camera_floor = workspace.T_camera_workspace;
  scene.workspace_m = workspace.kept_m();
  const Plane stated = plane_of_floor(scene.T_camera_floor);
  std::optional<Plane> floor = sampling.find_plane(thinned, stated.normal, parameters);
  if (floor && has_bin) {
    const double error_m = floor->height_m(scene.T_camera_floor.translation().cast<float>());
    if (std::abs(error_m) > kFloorMismatch_m) floor.reset();
  }
  if (!floor && has_bin) floor = stated;
  scene.has_floor = floor.has_value();
  scene.cloud =
      floor ? above_plane(thinned, *floor, workspace.size_m.z() + workspace.heap_m, parameters)
            : thinned;
}

/// The same where it does not: the floor is the plane that is found, and the part's size says how
/// far above and beside it parts are looked for.
void cut_out_unknown(const Cloud& readings, double part_diameter_m,
                     const PreprocessParameters& parameters, const Sampling& sampling,
                     Scene& scene) {
  scene.funnel.after_passthrough_n = static_cast<std::uint32_t>(readings.size());
  const Cloud thinned = sampling.thin(readings);
  scene.funnel.after_voxel_grid_n = static_cast<std::uint32_t>(thinned.size());
  const auto floor = sampling.find_plane(thinned, std::nullopt, parameters);
  scene.has_floor = floor.has_value();
  if (floor) {
    const Cloud above = above_plane(thinned, *floor, kCropDiameters * part_diameter_m, parameters);
    scene.cloud = over_floor(above, thinned, *floor, part_diameter_m, parameters);
    scene.T_camera_floor = frame_on(*floor, scene.cloud);
  } else {
    scene.warnings.push_back(
        "no floor found and no bin given: heights count from the deepest point");
    scene.cloud = thinned;
    scene.T_camera_floor = frame_on(deepest_plane(thinned), thinned);
  }
  const Eigen::Isometry3f T_floor_camera = scene.T_camera_floor.inverse().cast<float>();
  for (const auto& p : scene.cloud.points_m) {
    scene.workspace_m.extend((T_floor_camera * p).cast<double>());
  }
}

}  // namespace

std::optional<Workspace> requested_workspace(const PlanRequest& request,
                                             const PreprocessParameters& parameters) {
  const Eigen::Isometry3d T_camera_base = request.T_base_camera.inverse();
  if (request.bin) {
    Workspace workspace{T_camera_base * request.bin->T_base_bin, request.bin->inner_size_m};
    workspace.size_m.head<2>().array() -= 2 * parameters.wall_margin_m;
    workspace.size_m = workspace.size_m.cwiseMax(0);
    workspace.heap_m = parameters.heap_m;
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

Eigen::AlignedBox3d Workspace::kept_m() const {
  const Eigen::Vector3d half_m(size_m.x() / 2, size_m.y() / 2, 0);
  return {-half_m - Eigen::Vector3d(0, 0, kFloorMismatch_m),
          half_m + Eigen::Vector3d(0, 0, size_m.z() + heap_m)};
}

Cloud passthrough(const Cloud& cloud, const Workspace& workspace) {
  const Eigen::Isometry3f T_workspace_camera = workspace.T_camera_workspace.inverse().cast<float>();
  const Eigen::AlignedBox3f kept_m = workspace.kept_m().cast<float>();
  return filtered(cloud, [&](const Eigen::Vector3f& p_camera) {
    return kept_m.contains(T_workspace_camera * p_camera);
  });
}

Scene cut_out_parts(const DepthFrame& frame, const Cloud& readings, const PlanRequest& request,
                    double part_diameter_m, const PreprocessParameters& parameters,
                    const Sampling& sampling) {
  Scene scene;
  scene.funnel.pixels_n = static_cast<std::uint32_t>(frame.depth.size());
  scene.funnel.readings_n = static_cast<std::uint32_t>(
      frame.depth.size() -
      static_cast<std::size_t>(std::count(frame.depth.begin(), frame.depth.end(), 0)));
  if (const auto workspace = requested_workspace(request, parameters)) {
    cut_out_known(readings, *workspace, request.bin.has_value(), parameters, sampling, scene);
  } else {
    cut_out_unknown(readings, part_diameter_m, parameters, sampling, scene);
  }
  scene.funnel.after_plane_n = static_cast<std::uint32_t>(scene.cloud.size());
  return scene;
}

}  // namespace graspd::perception
