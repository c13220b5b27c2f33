#pragma once

#include <filesystem>

namespace graspd::service {

/// A folder of its own that only this user may enter, for the socket between front and workers and
/// the configuration that workers read. Gone with the object; what a killed server could not
/// remove, the next one does: a folder that nobody holds a lock on is left over.
class PrivateDirectory {
 public:
  /// \throws std::system_error
  explicit PrivateDirectory(
      const std::filesystem::path& parent = std::filesystem::temp_directory_path());
  ~PrivateDirectory();
  PrivateDirectory(const PrivateDirectory&) = delete;
  PrivateDirectory& operator=(const PrivateDirectory&) = delete;

  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
  int lock_fd_ = -1;
};

}  // namespace graspd::service
