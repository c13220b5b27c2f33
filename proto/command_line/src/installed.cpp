#include "graspd/command_line/installed.hpp"

namespace graspd {

namespace fs = std::filesystem;

fs::path installed(const fs::path& relative) {
  std::error_code error;
  const fs::path folder = fs::read_symlink("/proc/self/exe", error).parent_path();
  if (!folder.string().ends_with("/usr/bin")) return {};
  const fs::path path = folder.parent_path().parent_path() / relative;
  return fs::exists(path, error) ? path : fs::path();
}

}  // namespace graspd
