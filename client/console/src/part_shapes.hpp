#pragma once

#include <filesystem>
#include <string>

#include "graspd/types/result.hpp"

namespace graspd::console {

/// A part's mesh as the page draws it: little-endian float32, 9 for each triangle, in metres.
/// \returns INVALID_ARGUMENT where the catalogue has no such part, or it is too large for a page.
Result<std::string> part_triangles(const std::filesystem::path& catalogue, const std::string& id);

}  // namespace graspd::console
