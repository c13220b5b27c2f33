#include "text_file.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <sstream>

namespace graspd::keys {
namespace {

constexpr off_t kLargest_bytes = 1 << 20;

/// A descriptor that closes itself.
class File {
 public:
  File(const std::filesystem::path& path, int flags, mode_t mode = 0)
      : fd_(open(path.c_str(), flags | O_CLOEXEC, mode)) {}
  ~File() {
    if (fd_ >= 0) close(fd_);
  }
  File(const File&) = delete;
  File& operator=(const File&) = delete;
  int fd() const { return fd_; }

 private:
  int fd_;
};

tl::unexpected<Error> cannot(std::string_view what, const std::filesystem::path& path, int error) {
  return invalid("{}: can't be {}: {}", path.string(), what, std::strerror(error));
}

Result<void> fill(const File& file, const std::filesystem::path& path, std::string_view text,
                  mode_t mode) {
  // The mode that was asked for, whatever the umask is.
  if (fchmod(file.fd(), mode) != 0) return cannot("written", path, errno);
  while (!text.empty()) {
    const ssize_t written_n = write(file.fd(), text.data(), text.size());
    if (written_n < 0 && errno == EINTR) continue;
    if (written_n < 0) return cannot("written", path, errno);
    text.remove_prefix(static_cast<std::size_t>(written_n));
  }
  if (fsync(file.fd()) != 0) return cannot("written", path, errno);
  return {};
}

}  // namespace

Result<TextFile> read_text(const std::filesystem::path& path) {
  // Not blocking: a pipe would wait for its writer.
  const File file(path, O_RDONLY | O_NONBLOCK);
  struct stat status {};
  if (file.fd() < 0 || fstat(file.fd(), &status) != 0) return cannot("read", path, errno);
  if (!S_ISREG(status.st_mode))
    return invalid(
        "{}: is no file, but a folder or the like; name a file that 'grasp keys' has written",
        path.string());
  if (status.st_size > kLargest_bytes) {
    return invalid("{}: has {} bytes, which no key file has", path.string(), status.st_size);
  }
  TextFile result;
  result.mode = status.st_mode & 07777U;
  result.text.resize(static_cast<std::size_t>(status.st_size));
  const ssize_t read_n = read(file.fd(), result.text.data(), result.text.size());
  if (read_n < 0) return cannot("read", path, errno);
  result.text.resize(static_cast<std::size_t>(read_n));
  return result;
}

Result<void> create_file(const std::filesystem::path& path, std::string_view text, mode_t mode) {
  const File file(path, O_WRONLY | O_CREAT | O_EXCL, mode & 0600U);
  if (file.fd() < 0) {
    if (errno == EEXIST) {
      return invalid(
          "{}: is there already, and keys are never overwritten; remove it first, or "
          "say another folder",
          path.string());
    }
    return cannot("made", path, errno);
  }
  auto filled = fill(file, path, text, mode);
  if (!filled) unlink(path.c_str());
  return filled;
}

Result<void> replace_file(const std::filesystem::path& path, std::string_view text, mode_t mode) {
  std::filesystem::path beside = path;
  beside += ".new";
  {
    const File file(beside, O_WRONLY | O_CREAT | O_TRUNC | O_NOFOLLOW, mode & 0600U);
    if (file.fd() < 0) return cannot("made", beside, errno);
    if (auto ok = fill(file, beside, text, mode); !ok) return ok;
  }
  if (rename(beside.c_str(), path.c_str()) != 0) return cannot("replaced", path, errno);
  return {};
}

std::vector<std::string> lines_of(std::string_view text) {
  std::istringstream stream{std::string(text)};
  std::vector<std::string> lines;
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  return lines;
}

std::vector<std::string> words_of(std::string_view line) {
  std::istringstream stream{std::string(line)};
  std::vector<std::string> words;
  for (std::string word; stream >> word;) words.push_back(word);
  return words;
}

bool says_nothing(std::string_view line) {
  const std::size_t first = line.find_first_not_of(" \t\r");
  return first == std::string_view::npos || line[first] == '#';
}

}  // namespace graspd::keys
