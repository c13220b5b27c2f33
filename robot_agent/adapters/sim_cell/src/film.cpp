#include "graspd/simulated/film.hpp"

#include "graspd/simulation/strip.hpp"

namespace graspd::agent {
namespace {

constexpr double kTakenEvery_s = 0.4, kShownFor_s = 0.1;
/// 15 s to look at, and 10 MB. An even number.
constexpr std::size_t kMostPictures = 150;
constexpr std::size_t kStripPictures = 4;

}  // namespace

Film::Film(sim_cell::PhysicsCell& cell, std::vector<simulation::Rgb> kind_colors) : cell_(cell) {
  const Bin& bin = cell.options().bin;
  const Bin& place = cell.options().place;
  const Eigen::Vector3d middle_m =
      (bin.T_base_bin.translation() + place.T_base_bin.translation()) / 2;
  view_.T_base_camera = simulation::looking_at(middle_m + Eigen::Vector3d(0.02, 0.05, 0.17),
                                               middle_m + Eigen::Vector3d(0.80, -0.58, 0.75));
  view_.kind_colors = std::move(kind_colors);
  cell_.every(kTakenEvery_s, [this] {
    if (instants_n_++ % stride_ == 0) take();
  });
}

Film::~Film() { cell_.every(kTakenEvery_s, {}); }

/// Where there are too many, every other one goes, and from then on half as many are taken.
void Film::take() {
  if (pictures_.size() == kMostPictures) {
    for (std::size_t i = 1; i < kMostPictures / 2; ++i) {
      pictures_[i] = std::move(pictures_[2 * i]);
    }
    pictures_.resize(kMostPictures / 2);
    stride_ *= 2;
  }
  pictures_.push_back(cell_.picture(view_));
}

Result<void> Film::write(const std::filesystem::path& path) const {
  std::vector<simulation::Picture> pictures = pictures_;
  pictures.push_back(cell_.picture(view_));
  if (auto ok = simulation::write_gif(path, pictures, kShownFor_s); !ok) return ok;
  return simulation::write_png(std::filesystem::path(path).replace_extension(".png"),
                               simulation::strip(pictures, kStripPictures));
}

}  // namespace graspd::agent
