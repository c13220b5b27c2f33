#include "graspd/perception/organised.hpp"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

namespace graspd::perception {
namespace {

/// Readings about as deep are of one surface. At an edge four or five of the eight around a reading
/// are, at a corner three.
constexpr float kAsDeep_m = 0.01F;
constexpr int kFewestNear = 4;
/// A lone pixel without a reading is a hole in a surface where this many around it are of one.
constexpr int kFewestAroundHole = 7;

/// The cells that the workspace may be seen in.
CellBox box_of(const Workspace& workspace, const CameraIntrinsics& camera) {
  const CellBox image{0, 0, camera.width_px - 1, camera.height_px - 1};
  const Eigen::AlignedBox3d kept_m = workspace.kept_m();
  Eigen::AlignedBox2d seen_px;
  for (const auto corner :
       {Eigen::AlignedBox3d::BottomLeftFloor, Eigen::AlignedBox3d::BottomRightFloor,
        Eigen::AlignedBox3d::TopLeftFloor, Eigen::AlignedBox3d::TopRightFloor,
        Eigen::AlignedBox3d::BottomLeftCeil, Eigen::AlignedBox3d::BottomRightCeil,
        Eigen::AlignedBox3d::TopLeftCeil, Eigen::AlignedBox3d::TopRightCeil}) {
    const Eigen::Vector3d p = workspace.T_camera_workspace * kept_m.corner(corner);
    if (p.z() <= 0) return image;  // it reaches behind the camera
    seen_px.extend(Eigen::Vector2d(p.x() / p.z() * camera.fx_px + camera.cx_px,
                                   p.y() / p.z() * camera.fy_px + camera.cy_px));
  }
  const auto at = [](double px, int last) {
    return static_cast<int>(std::clamp(px, -1.0, last + 1.0));
  };
  return {std::max(0, at(seen_px.min().x(), image.u_last)),
          std::max(0, at(seen_px.min().y(), image.v_last)),
          std::min(image.u_last, at(seen_px.max().x() + 1, image.u_last)),
          std::min(image.v_last, at(seen_px.max().y() + 1, image.v_last))};
}

/// Drops readings that belong to no surface: on an edge, the sensor sees a mean of front and back.
/// Fills lone holes in a surface. Real edges stay where they are.
void mend_readings(DepthGrid& grid) {
  const std::vector<float> z_m = grid.z_m;
  const std::ptrdiff_t row = grid.width_px;
  const std::ptrdiff_t around[] = {-row - 1, -row, -row + 1, -1, 1, row - 1, row, row + 1};
  const auto near_n = [&](const float* here, float surface_m) {
    int count = 0;
    for (const std::ptrdiff_t offset : around) {
      count += std::abs(here[offset] - surface_m) < kAsDeep_m;
    }
    return count;
  };
  for (int v = 1; v < grid.height_px - 1; ++v) {
    const float* here = &z_m[grid.index(0, v)];
    float* mended = &grid.z_m[grid.index(0, v)];
    for (std::ptrdiff_t u = 1; u < row - 1; ++u) {
      mended[u] = near_n(here + u, here[u]) >= kFewestNear ? here[u] : 0;
    }
    for (std::ptrdiff_t u = 1; u < row - 1; ++u) {
      if (here[u] > 0) continue;
      const float mean_m = (here[u - 1] + here[u + 1] + here[u - row] + here[u + row]) / 4;
      if (mean_m > 0 && near_n(here + u, mean_m) >= kFewestAroundHole) mended[u] = mean_m;
    }
  }
}

/// The points of all cells with a reading.
Cloud cloud_of(const DepthGrid& grid) {
  Cloud cloud;
  cloud.pixels = grid.pixels();
  cloud.points_m.reserve(grid.size());
  cloud.cells.reserve(grid.size());
  for (int v = 1; v < grid.height_px - 1; ++v) {
    for (int u = 1; u < grid.width_px - 1; ++u) {
      const std::size_t cell = grid.index(u, v);
      if (grid.z_m[cell] <= 0) continue;
      cloud.points_m.push_back(grid.point_m(u, v));
      cloud.cells.push_back(static_cast<std::uint32_t>(cell));
    }
  }
  return cloud;
}

/// Puts the cloud into the cells of the grid, with the normals from there. A point without a
/// surface faces the camera.
void settle(const DepthGrid& grid, Cloud& cloud) {
  cloud.pixels = grid.pixels();
  cloud.normals.resize(cloud.size());
  cloud.curvatures.resize(cloud.size());
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    const std::size_t cell = grid.cell_of(cloud.points_m[i]);
    cloud.cells[i] = static_cast<std::uint32_t>(cell);
    const Eigen::Vector3f& normal = grid.normals[cell];
    cloud.normals[i] = normal.isZero() ? Eigen::Vector3f(-cloud.points_m[i].normalized()) : normal;
    cloud.curvatures[i] = grid.curvatures[cell];
  }
}

}  // namespace

std::optional<BowedWalls> walls_of(const PlanRequest& request,
                                   const PreprocessParameters& parameters) {
  if (!request.bin) return std::nullopt;
  return bowed_walls(request.T_base_camera.inverse() * request.bin->T_base_bin,
                     request.bin->inner_size_m, parameters.wall_reach_m);
}

DepthGrid seen_in_workspace(const DepthFrame& frame, const PlanRequest& request,
                            const PreprocessParameters& parameters) {
  const CameraIntrinsics& camera = frame.camera;
  const auto workspace = requested_workspace(request, parameters);
  const CellBox box = workspace ? box_of(*workspace, camera)
                                : CellBox{0, 0, camera.width_px - 1, camera.height_px - 1};
  DepthGrid seen = cut_out_readings(camera, readings_m(frame, parameters), box);
  if (const auto walls = walls_of(request, parameters)) {
    straighten(seen, *walls, parameters.wall_bow_m);
  }
  sharpen_edges(seen);
  mend_readings(seen);
  return seen;
}

Scene organised_readings(const DepthFrame& frame, const PlanRequest& request,
                         double part_diameter_m, const PreprocessParameters& parameters) {
  DepthGrid seen = seen_in_workspace(frame, request, parameters);
  Scene scene = cut_out_parts(frame, cloud_of(seen), request, part_diameter_m, parameters,
                              {std::identity(), fit_floor});
  DepthGrid grid = cut_out_readings(seen, box_around(scene.cloud, seen.pixels()));
  mark_parts(scene.cloud, grid);
  scene.grid = std::move(grid);
  scene.seen = std::move(seen);
  if (parameters.find_wall_bow) scene.walls = walls_of(request, parameters);
  return scene;
}

void add_normals(Scene& scene) {
  fit_normals(*scene.grid);
  settle(*scene.grid, scene.cloud);
}

Scene preprocess_organised(const DepthFrame& frame, const PlanRequest& request,
                           double part_diameter_m, const PreprocessParameters& parameters) {
  Scene scene = organised_readings(frame, request, part_diameter_m, parameters);
  add_normals(scene);
  return scene;
}

void drop_islands_without_segments(std::span<const Indices> segments, Scene& scene) {
  DepthGrid& grid = *scene.grid;
  const cv::Mat is_part(grid.height_px, grid.width_px, CV_8UC1, grid.is_part.data());
  cv::Mat_<int> islands;
  std::vector<std::uint8_t> has_segment(
      static_cast<std::size_t>(cv::connectedComponents(is_part, islands)), 0);
  const int* island_at = islands.ptr<int>();
  for (const Indices& segment : segments) {
    for (const std::uint32_t i : segment) has_segment[island_at[scene.cloud.cells[i]]] = 1;
  }
  for (std::size_t cell = 0; cell < grid.size(); ++cell) {
    if (has_segment[island_at[cell]] == 0) grid.take_for_floor(cell);
  }
}

}  // namespace graspd::perception
