#pragma once

#include <filesystem>

namespace graspd::parts {

/// The `version:` of a part.yaml: it counts up when the part's mesh is replaced. 1 where the file
/// does not say, or can't be read (`read_part_file` says why).
int read_part_version(const std::filesystem::path& path);

}  // namespace graspd::parts
