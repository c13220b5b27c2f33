#include "flight_folder.hpp"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>
#include <xxhash.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <vector>

namespace graspd::service {
namespace {

namespace fs = std::filesystem;

constexpr const char* kUnfinished = ".part";
constexpr std::size_t kLongestFolder = 200;

/// A cell's name as that of a folder: what could be more than a name, as % and two digits.
std::string folder_name(const std::string& cell) {
  std::string name;
  for (const char c : cell) {
    const bool plain = std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '-' || c == '_' ||
                       (c == '.' && !name.empty());
    name += plain ? std::string(1, c) : fmt::format("%{:02x}", static_cast<unsigned char>(c));
  }
  if (name.empty()) return "%";
  if (name.size() <= kLongestFolder) return name;
  return fmt::format("{}~{:016x}", name.substr(0, kLongestFolder),
                     XXH3_64bits(cell.data(), cell.size()));
}

tl::unexpected<Error> not_kept(const fs::path& path, std::string_view why) {
  return fail(Code::kInternal, "{} could not be kept: {}", path.string(), why);
}

/// \returns 0, or errno.
int write_file(const fs::path& path, const std::string& bytes) {
  const int fd = ::open(path.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0600);
  if (fd < 0) return errno;
  std::size_t written_n = 0;
  int error = 0;
  while (error == 0 && written_n < bytes.size()) {
    const ssize_t n = write(fd, bytes.data() + written_n, bytes.size() - written_n);
    if (n >= 0) {
      written_n += static_cast<std::size_t>(n);
    } else if (errno != EINTR) {
      error = errno;
    }
  }
  if (close(fd) != 0 && error == 0) error = errno;
  return error;
}

}  // namespace

FlightFolder::~FlightFolder() {
  if (lock_fd_ >= 0) close(lock_fd_);
}

fs::path FlightFolder::path_of(const std::string& cell, const std::string& name) const {
  return folder_ / folder_name(cell) / name;
}

Result<void> FlightFolder::add(const std::string& cell, const std::string& name,
                               const std::string& bytes) {
  const fs::path path = path_of(cell, name);
  if (bytes.size() > limits_.bytes)
    return not_kept(path, "it is larger than the whole folder may be");
  try {
    if (auto ok = open(); !ok) return not_kept(path, ok.error().message);
    const std::string cell_folder = folder_name(cell);
    make_room(cell_folder, bytes.size());
    fs::create_directories(path.parent_path());
    fs::permissions(path.parent_path(), fs::perms::owner_all);
    const fs::path unfinished = path.string() + kUnfinished;
    std::error_code error(write_file(unfinished, bytes), std::generic_category());
    if (!error) fs::rename(unfinished, path, error);
    if (error) {
      std::error_code ignored;
      fs::remove(unfinished, ignored);
      return not_kept(path, error.message());
    }
    cells_[cell_folder].push_back({name, bytes.size()});
    bytes_ += bytes.size();
    return {};
  } catch (const fs::filesystem_error& error) {
    return not_kept(path, error.code().message());
  }
}

/// While another server holds the folder, each `add` tries again: that one may be about to end.
Result<void> FlightFolder::open() {
  if (lock_fd_ >= 0) return {};
  if (fs::create_directories(folder_)) fs::permissions(folder_, fs::perms::owner_all);
  const fs::path lock = folder_ / ".lock";
  const int fd = ::open(lock.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0600);
  if (fd < 0) return fail(Code::kInternal, "{}", std::strerror(errno));
  if (flock(fd, LOCK_EX | LOCK_NB) != 0) {
    close(fd);
    return fail(Code::kInternal, "another server records into this folder; give each its own");
  }
  lock_fd_ = fd;
  count_what_is_there();
  return {};
}

void FlightFolder::count_what_is_there() {
  for (const auto& cell : fs::directory_iterator(folder_)) {
    if (!cell.is_directory()) continue;
    std::deque<File> files;
    for (const auto& file : fs::directory_iterator(cell.path())) {
      if (file.path().extension() == kUnfinished) {
        fs::remove(file.path());
      } else {
        files.push_back({file.path().filename().string(), file.file_size()});
        bytes_ += files.back().bytes;
      }
    }
    std::ranges::sort(files, {}, &File::name);
    if (!files.empty()) cells_[cell.path().filename().string()] = std::move(files);
  }
}

void FlightFolder::make_room(const std::string& cell_folder, std::uint64_t bytes) {
  while (true) {
    const auto cell = cells_.find(cell_folder);
    if (cell == cells_.end() || cell->second.size() < limits_.per_cell_n) break;
    remove_oldest(cell);
  }
  while (bytes_ + bytes > limits_.bytes && !cells_.empty()) {
    remove_oldest(std::ranges::min_element(cells_, {}, [](const auto& folder_and_files) {
      return folder_and_files.second.front().name;
    }));
  }
}

void FlightFolder::remove_oldest(Cells::iterator cell) {
  const fs::path folder = folder_ / cell->first;
  const File& oldest = cell->second.front();
  fs::remove(folder / oldest.name);  // somebody may have taken it away before us
  bytes_ -= oldest.bytes;
  cell->second.pop_front();
  if (!cell->second.empty()) return;
  cells_.erase(cell);
  std::error_code not_empty;
  fs::remove(folder, not_empty);
}

}  // namespace graspd::service
