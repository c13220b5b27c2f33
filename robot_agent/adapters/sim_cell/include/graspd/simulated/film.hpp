#pragma once

#include <filesystem>
#include <vector>

#include "graspd/sim_cell/physics_cell.hpp"

namespace graspd::agent {

/// An animation of a simulated cell at work, from its beginning to its end: however long that
/// takes, of at most so many pictures, in equal steps of the cell's own time.
class Film {
 public:
  /// From now on pictures are taken. \param cell must outlive the film
  /// \param kind_colors one for each kind of part
  Film(sim_cell::PhysicsCell& cell, std::vector<simulation::Rgb> kind_colors);
  ~Film();
  Film(const Film&) = delete;
  Film& operator=(const Film&) = delete;

  /// As a GIF, that ends with the cell as it is now, and beside it as a PNG of the same name: four
  /// of its pictures in a row.
  Result<void> write(const std::filesystem::path& path) const;

 private:
  void take();

  sim_cell::PhysicsCell& cell_;
  sim_cell::PictureView view_;
  std::size_t instants_n_ = 0;
  std::size_t stride_ = 1;  ///< of the instants, a picture is taken at every so many
  std::vector<simulation::Picture> pictures_;
};

}  // namespace graspd::agent
