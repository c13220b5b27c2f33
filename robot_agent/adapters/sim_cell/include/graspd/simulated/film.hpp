#pragma once

#include <filesystem>
#include <vector>

#include "graspd/sim_cell/physics_cell.hpp"

namespace graspd::agent {

/// An animation of a simulated cell at work, in steps of its own time.
class Film {
 public:
  /// From now on pictures are taken. \param cell must outlive the film
  /// \param kind_colors one for each kind of part
  Film(sim_cell::PhysicsCell& cell, std::vector<sim_cell::Rgb> kind_colors);
  ~Film();
  Film(const Film&) = delete;
  Film& operator=(const Film&) = delete;

  /// As a GIF.
  Result<void> write(const std::filesystem::path& path) const;

 private:
  sim_cell::PhysicsCell& cell_;
  std::vector<sim_cell::Picture> pictures_;
};

}  // namespace graspd::agent
