#pragma once

#include <filesystem>

namespace graspd::service {

/// A folder of its own that only this user may enter, gone with the object: for the socket between
/// front and workers, and the configuration that workers read.
class PrivateDirectory {
 public:
  /// \throws std::system_error
  PrivateDirectory();
  ~PrivateDirectory();
  PrivateDirectory(const PrivateDirectory&) = delete;
  PrivateDirectory& operator=(const PrivateDirectory&) = delete;

  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

}  // namespace graspd::service
