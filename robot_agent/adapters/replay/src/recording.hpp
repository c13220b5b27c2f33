#pragma once

#include <filesystem>
#include <memory>

#include "graspd/agent/ports.hpp"

namespace graspd::replay {

/// One pass through a recording, its frames as they are in the files.
Result<std::unique_ptr<agent::Camera>> open_bop_scene(const std::filesystem::path& directory);
Result<std::unique_ptr<agent::Camera>> open_rawlog(const std::filesystem::path& path);

}  // namespace graspd::replay
