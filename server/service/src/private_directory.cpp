#include "graspd/service/private_directory.hpp"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <string>
#include <system_error>

namespace graspd::service {
namespace {

constexpr std::string_view kPrefix = "graspd-serve-";

/// A lock on a folder, or -1. Locks, unlike process numbers, hold across containers.
int try_lock(const std::filesystem::path& folder) {
  const int fd = open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC);
  if (fd >= 0 && flock(fd, LOCK_EX | LOCK_NB) != 0) {
    close(fd);
    return -1;
  }
  return fd;
}

bool is_ours(const std::filesystem::path& folder) {
  struct stat status {};
  return lstat(folder.c_str(), &status) == 0 && S_ISDIR(status.st_mode) &&
         status.st_uid == geteuid();
}

void remove_left_overs(const std::filesystem::path& parent) {
  std::error_code ignored;
  for (const auto& entry : std::filesystem::directory_iterator(parent, ignored)) {
    if (!entry.path().filename().string().starts_with(kPrefix) || !is_ours(entry.path())) continue;
    const int fd = try_lock(entry.path());
    if (fd < 0) continue;
    std::filesystem::remove_all(entry.path(), ignored);
    close(fd);
  }
}

}  // namespace

PrivateDirectory::PrivateDirectory(const std::filesystem::path& parent) {
  remove_left_overs(parent);
  // Locked under another name first: under its own it is never without a lock.
  std::string pattern = parent / ("." + std::string(kPrefix) + "XXXXXX");
  if (mkdtemp(pattern.data()) == nullptr) {
    throw std::system_error(errno, std::generic_category(), "cannot make the folder " + pattern);
  }
  lock_fd_ = try_lock(pattern);
  path_ = parent / std::filesystem::path(pattern).filename().string().substr(1);
  std::filesystem::rename(pattern, path_);
}

PrivateDirectory::~PrivateDirectory() {
  std::error_code ignored;
  std::filesystem::remove_all(path_, ignored);
  close(lock_fd_);
}

}  // namespace graspd::service
