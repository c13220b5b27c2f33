#include "graspd/calibration/views.hpp"

#include "graspd/formats/depth_image.hpp"
#include "graspd/formats/mirror.hpp"
#include "graspd/formats/yaml.hpp"

namespace graspd::calibration {
namespace {

struct Entry {
  std::string image;
  std::string depth;
  std::optional<Eigen::Isometry3d> T_base_flange;
};

Board read_board(YamlMap map) {
  Board board;
  map.required("columns_n", board.columns_n);
  map.required("rows_n", board.rows_n);
  map.required("square_m", board.square_m);
  map.required("marker_m", board.marker_m);
  map.optional("dictionary", board.dictionary);
  map.optional("margin_m", board.margin_m);
  return board;
}

Entry read_entry(YamlMap map) {
  Entry entry;
  map.required("image", entry.image);
  map.optional("depth", entry.depth);
  if (map.has("T_base_flange")) map.required("T_base_flange", entry.T_base_flange.emplace());
  return entry;
}

Result<void> expect_size(const std::filesystem::path& path, int width_px, int height_px,
                         const CameraIntrinsics& camera) {
  if (width_px == camera.width_px && height_px == camera.height_px) return {};
  return invalid("{}: {} × {} pixels, but the camera's intrinsics are for {} × {}", path.string(),
                 width_px, height_px, camera.width_px, camera.height_px);
}

/// \param camera of the image once it is mirrored back.
Result<DepthFrame> read_depth(const std::filesystem::path& path, const CameraIntrinsics& camera,
                              double depth_scale_m, bool is_mirrored) {
  auto image = read_png16(path);
  if (!image) return tl::unexpected(image.error());
  if (auto ok = expect_size(path, image->width_px, image->height_px, camera); !ok) {
    return tl::unexpected(ok.error());
  }
  if (is_mirrored) mirror_rows(image->values, image->width_px);
  return DepthFrame{camera, depth_scale_m, std::move(image->values)};
}

}  // namespace

Result<Recording> read_recording(const std::filesystem::path& folder,
                                 const CameraIntrinsics& camera, double depth_scale_m) {
  Recording recording;
  std::vector<Entry> entries;
  YamlDocument document(folder / "poses.yaml");
  YamlMap root = document.root();
  recording.board = read_board(root.map("board"));
  bool is_mirrored = false;
  root.optional("mirrored", is_mirrored);
  for (const YamlMap& map : root.list_of_maps("views")) entries.push_back(read_entry(map));
  if (entries.empty()) root.fault("views", "'views' must name at least one image");
  if (auto ok = document.finish(); !ok) return tl::unexpected(ok.error());
  recording.camera = is_mirrored ? mirrored(camera) : camera;

  for (const Entry& entry : entries) {
    auto image = read_gray_image(folder / entry.image, is_mirrored);
    if (!image) return tl::unexpected(image.error());
    const auto ok = expect_size(folder / entry.image, image->width_px, image->height_px, camera);
    if (!ok) return tl::unexpected(ok.error());
    RecordedView& view = recording.views.emplace_back(
        RecordedView{entry.image, *std::move(image), entry.T_base_flange, std::nullopt});
    if (entry.depth.empty()) continue;
    auto depth = read_depth(folder / entry.depth, recording.camera, depth_scale_m, is_mirrored);
    if (!depth) return tl::unexpected(depth.error());
    view.depth = *std::move(depth);
  }
  return recording;
}

}  // namespace graspd::calibration
