#include "graspd/formats/bop.hpp"
#include "recording.hpp"

namespace graspd::replay {
namespace {

class BopCamera final : public agent::Camera {
 public:
  explicit BopCamera(BopScene scene) : scene_(std::move(scene)) {}

  Result<std::optional<DepthFrame>> next() override {
    if (given_n_ == scene_.image_ids().size()) return std::nullopt;
    auto image = scene_.read(scene_.image_ids()[given_n_]);
    if (!image) {
      return invalid("{} (broken after {} of {} frames)", image.error().message, given_n_,
                     scene_.image_ids().size());
    }
    const Eigen::Matrix<double, 4, 8> standing = where_all_stands(*image);
    if (given_n_ == 0) standing_ = standing;
    if (!standing.isApprox(standing_, 1e-6)) {
      return invalid(
          "{}: in image {} camera or bin stand elsewhere than in image {}; the frames of "
          "one cell are from a fixed camera",
          scene_.directory().string(), image->im_id, scene_.image_ids().front());
    }
    ++given_n_;
    return std::move(image->frame);
  }

 private:
  static Eigen::Matrix<double, 4, 8> where_all_stands(const BopImage& image) {
    const BopBin bin = image.bin.value_or(BopBin{});
    Eigen::Matrix<double, 4, 8> poses;
    poses << image.T_world_camera.value_or(Eigen::Isometry3d::Identity()).matrix(),
        bin.T_camera_bin.matrix();
    return poses;
  }

  BopScene scene_;
  Eigen::Matrix<double, 4, 8> standing_;
  std::size_t given_n_ = 0;
};

}  // namespace

Result<std::unique_ptr<agent::Camera>> open_bop_scene(const std::filesystem::path& directory) {
  auto scene = BopScene::open(directory);
  if (!scene) return tl::unexpected(scene.error());
  return std::make_unique<BopCamera>(*std::move(scene));
}

}  // namespace graspd::replay
