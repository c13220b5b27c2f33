#include "graspd/onboarding/pictures.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>

#include "graspd/simulation/picture.hpp"

namespace graspd::onboarding {
namespace {

constexpr int kPicture_px = 300;
constexpr int kFiner = 3;  ///< drawn so many times as large, for smooth edges
constexpr simulation::Rgb kPartColor{86, 180, 233};
constexpr simulation::Rgb kTableColor{226, 226, 222};
constexpr simulation::Rgb kJawColor{230, 120, 20};
/// From where it is looked at: above the horizon, and turned from the closing direction.
constexpr double kElevation_rad = 0.6;
constexpr double kAzimuth_rad = -1.15;

parts::Mesh box_of(const Eigen::AlignedBox3d& box) {
  parts::Mesh mesh;
  for (int corner = 0; corner < 8; ++corner) {
    const auto type = static_cast<Eigen::AlignedBox3d::CornerType>(corner);
    mesh.vertices_m.push_back(box.corner(type).cast<float>());
  }
  mesh.triangles = {{0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}, {0, 1, 5}, {0, 5, 4},
                    {2, 6, 7}, {2, 7, 3}, {0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}};
  return mesh;
}

/// Round and flat, its upper side at z = 0.
parts::Mesh table_of(double radius_m) {
  constexpr int kCorners = 72;
  parts::Mesh mesh;
  mesh.vertices_m.emplace_back(0, 0, 0);
  for (int i = 0; i < kCorners; ++i) {
    const double angle_rad = 2 * M_PI * i / kCorners;
    mesh.vertices_m.push_back(
        Eigen::Vector3d(radius_m * std::cos(angle_rad), radius_m * std::sin(angle_rad), 0)
            .cast<float>());
    mesh.triangles.push_back({0, i + 1, (i + 1) % kCorners + 1});
  }
  return mesh;
}

struct Thing {
  const parts::Mesh& mesh;
  Eigen::Isometry3d T_world_mesh = Eigen::Isometry3d::Identity();
  simulation::Rgb color;
};

/// Means of kFiner × kFiner pixels.
overlay::RgbImage smaller(const simulation::Picture& fine) {
  overlay::RgbImage image{fine.width_px / kFiner, fine.height_px / kFiner, {}};
  for (int y = 0; y < image.height_px; ++y) {
    for (int x = 0; x < image.width_px; ++x) {
      std::array<int, 3> sum{};
      for (int i = 0; i < kFiner * kFiner; ++i) {
        const int row = y * kFiner + i / kFiner, column = x * kFiner + i % kFiner;
        const auto& pixel = fine.pixels[static_cast<std::size_t>(row * fine.width_px + column)];
        for (std::size_t c = 0; c < 3; ++c) sum[c] += pixel[c];
      }
      std::array<std::uint8_t, 3> mean{};
      for (std::size_t c = 0; c < 3; ++c) {
        mean[c] = static_cast<std::uint8_t>(sum[c] / (kFiner * kFiner));
      }
      image.pixels.push_back(mean);
    }
  }
  return image;
}

/// What lies within a ball, from far enough to see it all.
overlay::RgbImage draw(const std::vector<Thing>& things, const Eigen::Vector3d& centre_m,
                       double radius_m) {
  constexpr int kSide_px = kPicture_px * kFiner;
  constexpr double kFocal_px = 2.5 * kSide_px;
  const Eigen::Vector3d out(std::cos(kElevation_rad) * std::cos(kAzimuth_rad),
                            std::cos(kElevation_rad) * std::sin(kAzimuth_rad),
                            std::sin(kElevation_rad));
  const double distance_m = kFocal_px * radius_m / (0.47 * kSide_px);
  const Eigen::Isometry3d T_camera_world =
      simulation::looking_at(centre_m, centre_m + distance_m * out).inverse();
  std::vector<simulation::SceneObject> objects;
  std::vector<simulation::Rgb> colors;
  for (const Thing& thing : things) {
    objects.push_back({&thing.mesh, T_camera_world * thing.T_world_mesh});
    colors.push_back(thing.color);
  }
  const CameraIntrinsics camera{kSide_px,       kSide_px,       kFocal_px, kFocal_px,
                                kSide_px / 2.0, kSide_px / 2.0, {}};
  return smaller(simulation::shaded(simulation::render(camera, objects), colors));
}

}  // namespace

overlay::RgbImage picture_of(const parts::Part& part, const StablePose& pose) {
  Eigen::Isometry3d T_world_part = Eigen::Isometry3d::Identity();
  T_world_part.linear() =
      Eigen::Quaterniond::FromTwoVectors(pose.down, -Eigen::Vector3d::UnitZ()).toRotationMatrix();
  T_world_part.translation() =
      Eigen::Vector3d(0, 0, pose.height_m) - T_world_part.linear() * part.barycentre_m;
  const parts::Mesh table = table_of(1.15 * part.radius_m);
  return draw(
      {{part.mesh, T_world_part, kPartColor}, {table, Eigen::Isometry3d::Identity(), kTableColor}},
      {0, 0, 0.6 * pose.height_m}, 1.2 * part.radius_m);
}

overlay::RgbImage picture_of(const parts::Part& part, const parts::PickPoint& point,
                             const Gripper& gripper) {
  // The grasp's frame, but z up, against the approach.
  Eigen::Isometry3d T_part_world = Eigen::Isometry3d::Identity();
  T_part_world.linear() << point.closing, -point.approach.cross(point.closing), -point.approach;
  T_part_world.translation() = point.position_m;
  const Eigen::Isometry3d T_world_part = T_part_world.inverse();

  std::vector<parts::Mesh> boxes;
  const double tip_m = -point.tip_reach_m;
  const double inner_m = point.width_m / 2 + gripper.clearance_m;
  const double outer_m = inner_m + gripper.jaw_size_m.x();
  const double half_m = gripper.jaw_size_m.y() / 2;
  const double top_m = tip_m + std::min(gripper.jaw_size_m.z(), 1.2 * part.radius_m);
  boxes.push_back(
      box_of({Eigen::Vector3d(inner_m, -half_m, tip_m), Eigen::Vector3d(outer_m, half_m, top_m)}));
  boxes.push_back(box_of(
      {Eigen::Vector3d(-outer_m, -half_m, tip_m), Eigen::Vector3d(-inner_m, half_m, top_m)}));
  std::vector<Thing> things{{part.mesh, T_world_part, kPartColor}};
  for (const parts::Mesh& box : boxes) {
    things.push_back({box, Eigen::Isometry3d::Identity(), kJawColor});
  }
  return draw(things, T_world_part * part.barycentre_m + Eigen::Vector3d(0, 0, 0.2 * part.radius_m),
              1.35 * part.radius_m);
}

}  // namespace graspd::onboarding
