#pragma once

#include <filesystem>

#include "graspd/parts/part.hpp"

namespace graspd::eval {

/// A part that no catalogue has: all that is known of it is its mesh. Its id is the file's name
/// without the extension.
Result<parts::Part> mesh_part(const std::filesystem::path& mesh, parts::LengthUnit unit,
                              int bop_obj_id);

}  // namespace graspd::eval
