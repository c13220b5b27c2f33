#pragma once

#include <filesystem>

#include "arm_data.hpp"
#include "graspd/types/result.hpp"

namespace graspd::motion {

/// As `ArmModel::load`.
Result<ArmData> read_urdf(const std::filesystem::path& path);

}  // namespace graspd::motion
