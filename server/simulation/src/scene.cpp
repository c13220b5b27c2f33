#include "graspd/simulation/scene.hpp"

#include <cmath>

#include "graspd/simulation/bin_mesh.hpp"
#include "graspd/types/mean_frame.hpp"

namespace graspd::simulation {
namespace {

/// 0 for all but the first `parts_n` objects, whose ids count from 1.
Image16 instance_ids(const Rendering& rendering, std::size_t parts_n) {
  Image16 ids{rendering.camera.width_px, rendering.camera.height_px, {}};
  ids.values.reserve(rendering.object.size());
  for (const std::int32_t object : rendering.object) {
    const bool is_part = object != Rendering::kNothing && std::size_t(object) < parts_n;
    ids.values.push_back(std::uint16_t(is_part ? object + 1 : 0));
  }
  return ids;
}

/// Seeds of a frame's further looks: far from those of the next frames.
constexpr std::uint64_t kLookSeed = 1'000'003;

Result<DepthFrame> look(const StillScene& scene, std::uint64_t seed, int looks_n) {
  std::vector<DepthFrame> looks;
  for (std::uint64_t i = 0; i < static_cast<std::uint64_t>(looks_n); ++i) {
    looks.push_back(scene.look(seed + i * kLookSeed));
  }
  return mean_frame(looks);
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
    const auto part = catalogue.get(count.part_id);
    if (!part) return tl::unexpected(part.error());
    kinds.push_back(*part);
    meshes.push_back((*part)->mesh);
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
  std::vector<SceneObject> scene;
  for (const PiledPart& part : pile->parts) {
    scene.push_back({&kinds_[part.kind]->mesh, T_camera_bin * part.T_bin_part, options_.gloss});
  }
  const std::size_t parts_n = scene.size();
  scene.push_back({&bin_, T_camera_bin});

  BopImage image;
  image.im_id = k;
  const Walls walls{T_camera_bin, options_.bin_inner_size_m};
  auto frame = look(StillScene(scene, options_.sensor, walls), seed, options_.looks_n);
  if (!frame) return tl::unexpected(frame.error());
  image.frame = *std::move(frame);
  const Rendering truth = render(options_.sensor.camera, scene);
  const std::vector<double> fractions = visible_fractions(truth, scene);
  for (std::size_t i = 0; i < parts_n; ++i) {
    image.truth.push_back(
        {kinds_[pile->parts[i].kind]->bop_obj_id, scene[i].T_camera_object, fractions[i]});
  }
  image.instance = instance_ids(truth, parts_n);
  image.bin = BopBin{T_camera_bin, options_.bin_inner_size_m};
  image.T_world_camera = T_camera_bin.inverse();
  return image;
}

}  // namespace graspd::simulation
