#pragma once

#include <filesystem>

namespace graspd {

/// Where this program's package has put a file or folder: `usr/share/graspd/parts` or
/// `etc/graspd/server.yaml`, seen from the root that holds the program's own usr/bin.
/// \returns an empty path where it is not there, as for a program in a build folder.
std::filesystem::path installed(const std::filesystem::path& relative);

}  // namespace graspd
