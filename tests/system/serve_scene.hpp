#pragma once

#include <fmt/format.h>

#include <fstream>

#include "block_scene.hpp"
#include "graspd/formats/depth_image.hpp"
#include "temporary_folder.hpp"

/// What a small cell has on disk: parts, a camera's calibration, a bin, a frame.
namespace graspd::testing {

inline void write_box_part(const TemporaryFolder& folder, const std::string& id, int bop_obj_id,
                           const Eigen::Vector3d& size_mm) {
  const parts::Part part = block_part(id, size_mm / 1000);
  std::string stl = "solid box\n";
  for (const auto& triangle : part.mesh.triangles) {
    stl += "facet normal 0 0 0\nouter loop\n";
    for (const int vertex : triangle) {
      const Eigen::Vector3f p = part.mesh.vertices_m[static_cast<std::size_t>(vertex)] * 1000;
      stl += fmt::format("vertex {} {} {}\n", p.x(), p.y(), p.z());
    }
    stl += "endloop\nendfacet\n";
  }
  folder.write("parts/" + id + "/box.stl", stl + "endsolid box\n");
  folder.write("parts/" + id + "/part.yaml",
               fmt::format("id: {}\nname: {}\nbop_obj_id: {}\nmesh: box.stl\n"
                           "mesh_unit: mm\n",
                           id, id, bop_obj_id));
}

inline std::filesystem::path write_camera(const TemporaryFolder& folder, const std::string& name,
                                          const CameraIntrinsics& camera, double height_m) {
  return folder.write(
      name, fmt::format("%YAML:1.0\n---\nimage_width: {}\nimage_height: {}\n"
                        "camera_matrix: !!opencv-matrix\n   rows: 3\n   cols: 3\n   dt: d\n"
                        "   data: [{}, 0., {}, 0., {}, {}, 0., 0., 1.]\n"
                        "distortion_coefficients: !!opencv-matrix\n   rows: 1\n   cols: 5\n"
                        "   dt: d\n   data: [0., 0., 0., 0., 0.]\n"
                        "T_base_camera: [1, 0, 0, 0, 0, -1, 0, 0, 0, 0, -1, {}, 0, 0, 0, 1]\n",
                        camera.width_px, camera.height_px, camera.fx_px, camera.cx_px, camera.fy_px,
                        camera.cy_px, height_m));
}

inline std::filesystem::path write_frame(const TemporaryFolder& folder, const std::string& name,
                                         const DepthFrame& frame) {
  const auto path = folder.path() / name;
  const auto written =
      write_png16(path, {frame.camera.width_px, frame.camera.height_px, frame.depth});
  if (!written) throw std::runtime_error(written.error().message);
  return path;
}

inline constexpr double kHeight_m = 0.75;
inline const Eigen::Vector3d kBar_m(0.08, 0.024, 0.02);

/// A bar on the floor, away from the image's centre.
inline Block bar_at(double x_m, double y_m, double angle_rad, const Eigen::Vector3d& size_m) {
  Block block;
  block.size_m = size_m;
  block.T_camera_block.translation() << x_m, y_m, kHeight_m - size_m.z() / 2;
  block.T_camera_block.linear() =
      Eigen::AngleAxisd(angle_rad, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  return block;
}

}  // namespace graspd::testing
