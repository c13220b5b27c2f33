#pragma once

#include <nlohmann/json.hpp>
#include <vector>

#include "graspd/formats/table.hpp"
#include "perception_growth.hpp"
#include "perception_runs.hpp"

/// What `./run bench perception` prints and writes.
namespace graspd::bench {

/// A row for each method, beside what graspd does on the same frames.
Table method_table(const std::vector<Run>& runs);
/// A row for each run.
Table raw_table(const std::vector<Run>& runs);

/// A row for each number of parts, with medians.
Table growth_table(const std::vector<GrowthRun>& runs);
Table raw_growth_table(const std::vector<GrowthRun>& runs);

nlohmann::json figures_of(const std::vector<Run>& runs, const std::vector<GrowthRun>& growth,
                          const parts::Catalogue& catalogue);

}  // namespace graspd::bench
