#include "graspd/keys/allow_list.hpp"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <algorithm>

#include "key_text.hpp"
#include "text_file.hpp"

namespace graspd::keys {
namespace {

constexpr std::string_view kHeader =
    "# Cells that may use grasp_server, a line each: name and public key, as in their .pub files.\n"
    "# grasp keys allow | revoke | list; a running server reads it again on SIGHUP.\n";

/// Held while a list is changed, so that of two changes at once none is lost. A file beside it,
/// since the list itself is replaced by each change.
class ListLock {
 public:
  explicit ListLock(const std::filesystem::path& list)
      : fd_(open((list.string() + ".lock").c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0600)) {
    if (fd_ >= 0) flock(fd_, LOCK_EX);
  }
  ~ListLock() {
    if (fd_ >= 0) close(fd_);
  }
  ListLock(const ListLock&) = delete;
  ListLock& operator=(const ListLock&) = delete;

 private:
  int fd_;
};

}  // namespace

Result<AllowList> AllowList::read(const std::filesystem::path& path) {
  const auto file = read_text(path);
  if (!file) return tl::unexpected(file.error());
  if ((file->mode & 022U) != 0) {
    return invalid(
        "{}: others than its user may write it (mode {:04o}), and so let themselves in; chmod 644 "
        "it, and look at what it says",
        path.string(), file->mode);
  }
  AllowList list;
  std::size_t number = 0;
  for (const std::string& line : lines_of(file->text)) {
    ++number;
    if (!says_nothing(line)) list.take(line, fmt::format("{}:{}", path.string(), number));
  }
  return list;
}

void AllowList::take(const std::string& line, const std::string& place) {
  const std::vector<std::string> words = words_of(line);
  if (words.size() == 3 && is_key(words[1]) && is_key(words[2])) {
    faults_.push_back(fmt::format(
        "{}: holds a secret key, which is no secret any more; make another one", place));
  } else if (words.size() != 2 || !validate_cell_name(words[0]) || !is_key(words[1])) {
    faults_.push_back(fmt::format(
        "{}: is no line of a cell's name and its public key, as .pub files have it", place));
  } else if (!cells_.emplace(words[1], words[0]).second) {
    faults_.push_back(fmt::format("{}: this key is '{}' already; a cell has its own", place,
                                  cells_.at(words[1])));
  } else {
    entries_.push_back({words[0], words[1]});
  }
}

std::optional<std::string_view> AllowList::cell_of(std::string_view public_key) const {
  const auto found = cells_.find(public_key);
  if (found == cells_.end()) return std::nullopt;
  return found->second;
}

Result<void> allow(const std::filesystem::path& path, const PublicKey& key) {
  const ListLock lock(path);
  if (!std::filesystem::exists(path)) {
    return create_file(path, std::string(kHeader) + public_line(key), 0644);
  }
  const auto list = AllowList::read(path);
  if (!list) return tl::unexpected(list.error());
  if (const auto cell = list->cell_of(key.public_key)) {
    return invalid("{}: this key is in the list already, as '{}'", path.string(), *cell);
  }
  auto file = read_text(path);
  if (!file) return tl::unexpected(file.error());
  if (!file->text.empty() && file->text.back() != '\n') file->text += '\n';
  return replace_file(path, file->text + public_line(key), file->mode);
}

Result<std::size_t> revoke(const std::filesystem::path& path, std::string_view cell) {
  const ListLock lock(path);
  const auto file = read_text(path);
  if (!file) return tl::unexpected(file.error());
  std::string kept;
  std::size_t revoked_n = 0;
  for (const std::string& line : lines_of(file->text)) {
    if (!says_nothing(line) && words_of(line)[0] == cell) {
      ++revoked_n;
    } else {
      kept += line + '\n';
    }
  }
  if (revoked_n == 0) {
    return invalid("{}: there is no key of '{}'; 'grasp keys list' says which there are",
                   path.string(), cell);
  }
  if (auto ok = replace_file(path, kept, file->mode); !ok) return tl::unexpected(ok.error());
  return revoked_n;
}

}  // namespace graspd::keys
