#pragma once

#include <filesystem>
#include <functional>

#include "graspd/simulation/scene.hpp"

namespace graspd::sim_cell {

struct SceneReport {
  int frames_n = 0;
  int parts_n = 0;           ///< over all frames
  double visible_share = 0;  ///< of the parts: visible by half or more
};

/// Writes a BOP scene folder, and the same frames as an MRPT rawlog, `frames.rawlog`, inside it.
/// \param progress called after each frame with its number from 1.
Result<SceneReport> simulate_scene(const parts::Catalogue& catalogue,
                                   const simulation::SceneOptions& options,
                                   const std::filesystem::path& directory,
                                   const std::function<void(int)>& progress = {});

}  // namespace graspd::sim_cell
