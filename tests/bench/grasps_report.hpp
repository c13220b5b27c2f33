#pragma once

#include <nlohmann/json.hpp>
#include <span>

#include "graspd/formats/table.hpp"
#include "grasps_runs.hpp"

/// What `./run bench grasps` prints and writes.
namespace graspd::bench {

/// One row for each part, and one for all.
Table grasps_table(const std::vector<JudgedPile>& piles);
/// Why first grasps were not good: from the frames, and from the true poses.
Table causes_table(std::span<const JudgedPile> piles);
/// A row for each judged grasp.
Table grasp_records(std::span<const JudgedPile> piles);

/// The figures that targets are about. What nothing was measured for is null.
nlohmann::json grasps_figures(std::span<const JudgedPile> piles);
/// What grasps_plots.py draws.
nlohmann::json grasps_plot(std::span<const JudgedPile> piles);

}  // namespace graspd::bench
