#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "cells.hpp"
#include "graspd/types/result.hpp"

/// Single flight records, as the page gets them.
namespace graspd::console {

/// \param name as in PlanSeen. \returns INVALID_ARGUMENT for what is no name of a flight, or is no
/// longer kept in any of the folders.
Result<std::filesystem::path> find_flight(const std::vector<std::filesystem::path>& folders,
                                          const std::string& name);

/// \returns INVALID_ARGUMENT where the file is damaged or gone.
Result<PlanSeen> read_plan(const std::filesystem::path& file);

/// Camera, request and answer, as JSON.
Result<std::string> flight_json(const std::filesystem::path& file);

/// Little-endian uint16, row by row.
Result<std::string> flight_depth(const std::filesystem::path& file);

}  // namespace graspd::console
