#include "graspd/sim_cell/scene.hpp"

#include <cmath>

#include "graspd/recordings/rawlog.hpp"

namespace graspd::sim_cell {
namespace {

constexpr double kTableHalf_m = 1.5;
constexpr double kFramePeriod_s = 1.0 / 30;
constexpr double kHalfVisible = 0.5;

void add_box(const Eigen::Vector3d& low_m, const Eigen::Vector3d& high_m, parts::Mesh& mesh) {
  const auto first = static_cast<int>(mesh.vertices_m.size());
  for (int corner = 0; corner < 8; ++corner) {
    const Eigen::Vector3d p((corner & 1) != 0 ? high_m.x() : low_m.x(),
                            (corner & 2) != 0 ? high_m.y() : low_m.y(),
                            (corner & 4) != 0 ? high_m.z() : low_m.z());
    mesh.vertices_m.push_back(p.cast<float>());
  }
  constexpr int kFaces[12][3] = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                                 {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
  for (const auto& face : kFaces) {
    mesh.triangles.push_back({first + face[0], first + face[1], first + face[2]});
  }
}

/// Four walls on a table, in the bin's frame.
parts::Mesh bin_mesh(const Eigen::Vector3d& inner_m, double wall_m) {
  const double x = inner_m.x() / 2;
  const double y = inner_m.y() / 2;
  parts::Mesh mesh;
  add_box({-kTableHalf_m, -kTableHalf_m, -0.01}, {kTableHalf_m, kTableHalf_m, 0}, mesh);
  add_box({-x - wall_m, -y - wall_m, 0}, {-x, y + wall_m, inner_m.z()}, mesh);
  add_box({x, -y - wall_m, 0}, {x + wall_m, y + wall_m, inner_m.z()}, mesh);
  add_box({-x, -y - wall_m, 0}, {x, -y, inner_m.z()}, mesh);
  add_box({-x, y, 0}, {x, y + wall_m, inner_m.z()}, mesh);
  return mesh;
}

}  // namespace

Eigen::Isometry3d camera_over_bin(double height_m, double tilt_rad) {
  Eigen::Isometry3d T_bin_camera(Eigen::AngleAxisd(tilt_rad, Eigen::Vector3d::UnitX()));
  T_bin_camera.translate(Eigen::Vector3d(0, 0, height_m));
  T_bin_camera.rotate(Eigen::AngleAxisd(M_PI, Eigen::Vector3d::UnitX()));
  return T_bin_camera;
}

SceneMaker::SceneMaker(SceneOptions options, std::vector<const parts::Part*> kinds, PileMaker piles)
    : options_(std::move(options)),
      kinds_(std::move(kinds)),
      piles_(std::move(piles)),
      bin_(bin_mesh(options_.bin_inner_size_m, options_.bin_wall_m)) {}

Result<SceneMaker> SceneMaker::create(const parts::Catalogue& catalogue, SceneOptions options) {
  std::vector<const parts::Part*> kinds;
  std::vector<parts::Mesh> meshes;
  for (const PartCount& count : options.parts) {
    const parts::Part* part = catalogue.find(count.part_id);
    if (part == nullptr) {
      return fail(Code::kUnknownPart, "parts: no part '{}' in the catalogue", count.part_id);
    }
    kinds.push_back(part);
    meshes.push_back(part->mesh);
  }
  if (auto ok = validate(options.sensor.camera); !ok) return tl::unexpected(ok.error());
  const double to_rim_m = options.camera_height_m - options.bin_inner_size_m.z();
  if (!(to_rim_m >= options.sensor.min_depth_m)) {
    return invalid(
        "camera_height_m: {} m above the floor is {:.2f} m above the bin's rim; the "
        "sensor sees from {} m on",
        options.camera_height_m, to_rim_m, options.sensor.min_depth_m);
  }
  return SceneMaker(std::move(options), std::move(kinds), PileMaker(meshes));
}

Result<BopImage> SceneMaker::make(int k) const {
  const std::uint64_t seed = options_.seed + static_cast<std::uint64_t>(k);
  std::vector<int> counts;
  for (const PartCount& count : options_.parts) counts.push_back(count.count_n);
  const auto pile = piles_.drop(counts, options_.bin_inner_size_m, seed);
  if (!pile) return tl::unexpected(pile.error());

  const Eigen::Isometry3d T_camera_bin =
      camera_over_bin(options_.camera_height_m, options_.camera_tilt_rad).inverse();
  std::vector<PosedMesh> meshes;
  for (const PiledPart& part : pile->parts) {
    meshes.push_back({&kinds_[part.kind]->mesh, T_camera_bin * part.T_bin_part,
                      static_cast<std::uint16_t>(meshes.size() + 1)});
  }
  const std::size_t parts_n = meshes.size();
  std::vector<double> gloss(parts_n + 1, options_.gloss);
  gloss[0] = 0;
  meshes.push_back({&bin_, T_camera_bin, 0});

  BopImage image;
  image.im_id = k;
  image.frame =
      sense(meshes, Walls{T_camera_bin, options_.bin_inner_size_m}, gloss, options_.sensor, seed);
  const Rendering truth = render(options_.sensor.camera, meshes);
  const auto fractions = visible_fractions(options_.sensor.camera, {meshes.data(), parts_n}, truth);
  for (std::size_t i = 0; i < parts_n; ++i) {
    image.truth.push_back(
        {kinds_[pile->parts[i].kind]->bop_obj_id, meshes[i].T_camera_mesh, fractions[i]});
  }
  image.bin = BopBin{T_camera_bin, options_.bin_inner_size_m};
  image.T_world_camera = T_camera_bin.inverse();
  image.instance = Image16{truth.width_px, truth.height_px, truth.id};
  return image;
}

Result<SceneReport> simulate_scene(const parts::Catalogue& catalogue, const SceneOptions& options,
                                   const std::filesystem::path& directory,
                                   const std::function<void(int)>& progress) {
  const auto maker = SceneMaker::create(catalogue, options);
  if (!maker) return tl::unexpected(maker.error());
  std::error_code error;
  std::filesystem::create_directories(directory, error);
  if (error) return invalid("{}: can't be made: {}", directory.string(), error.message());
  BopSceneWriter scene(directory);
  auto rawlog = RawlogWriter::create(directory / "frames.rawlog");
  if (!rawlog) return tl::unexpected(rawlog.error());

  SceneReport report;
  int visible_n = 0;
  for (int k = 0; k < options.frames_n; ++k) {
    const auto image = maker->make(k);
    if (!image) return tl::unexpected(image.error());
    if (auto ok = scene.add(*image); !ok) return tl::unexpected(ok.error());
    if (auto ok = rawlog->add(image->frame, k * kFramePeriod_s); !ok) {
      return tl::unexpected(ok.error());
    }
    ++report.frames_n;
    report.parts_n += static_cast<int>(image->truth.size());
    for (const BopTruth& truth : image->truth) visible_n += truth.visible_fraction >= kHalfVisible;
    if (progress) progress(k + 1);
  }
  if (auto ok = scene.finish(); !ok) return tl::unexpected(ok.error());
  report.visible_share = report.parts_n == 0 ? 0 : double(visible_n) / report.parts_n;
  return report;
}

}  // namespace graspd::sim_cell
