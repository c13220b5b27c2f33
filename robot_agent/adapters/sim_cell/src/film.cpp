#include "graspd/simulated/film.hpp"

namespace graspd::agent {
namespace {

constexpr double kTakenEvery_s = 0.4, kShownFor_s = 0.1;
/// A minute of the cell's time, and 10 MB.
constexpr std::size_t kMostPictures = 150;

}  // namespace

Film::Film(sim_cell::PhysicsCell& cell, std::vector<sim_cell::Rgb> kind_colors) : cell_(cell) {
  const Bin& bin = cell.options().bin;
  const Bin& place = cell.options().place;
  const Eigen::Vector3d middle_m =
      (bin.T_base_bin.translation() + place.T_base_bin.translation()) / 2;
  sim_cell::PictureView view;
  view.T_base_camera = sim_cell::looking_at(middle_m + Eigen::Vector3d(0.02, 0.05, 0.17),
                                            middle_m + Eigen::Vector3d(0.80, -0.58, 0.75));
  view.kind_colors = std::move(kind_colors);
  cell_.every(kTakenEvery_s, [this, view] {
    if (pictures_.size() < kMostPictures) pictures_.push_back(cell_.picture(view));
  });
}

Film::~Film() { cell_.every(kTakenEvery_s, {}); }

Result<void> Film::write(const std::filesystem::path& path) const {
  return sim_cell::write_gif(path, pictures_, kShownFor_s);
}

}  // namespace graspd::agent
