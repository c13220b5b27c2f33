#include "folder_watch.hpp"

#include <poll.h>
#include <sys/inotify.h>
#include <unistd.h>

#include <array>
#include <system_error>

namespace graspd::console {
namespace {

namespace fs = std::filesystem;

constexpr std::uint32_t kEvents =
    IN_CREATE | IN_MOVED_TO | IN_CLOSE_WRITE | IN_MODIFY | IN_ONLYDIR | IN_EXCL_UNLINK;

}  // namespace

FolderWatch::FolderWatch(std::vector<fs::path> roots, std::set<std::string> skipped)
    : roots_(std::move(roots)),
      skipped_(std::move(skipped)),
      fd_(inotify_init1(IN_NONBLOCK | IN_CLOEXEC)) {
  if (fd_ < 0) throw std::system_error(errno, std::generic_category(), "inotify");
}

FolderWatch::~FolderWatch() { close(fd_); }

void FolderWatch::add(const fs::path& folder, std::set<fs::path>& files) {
  if (skipped_.contains(folder.filename().string())) return;
  const int watch = inotify_add_watch(fd_, folder.c_str(), kEvents);
  if (watch < 0) return;  // it is gone again, or is no folder
  folders_[watch] = folder;
  watched_.insert(folder);
  // What was made before the watch was is found here; what is made from now on comes as an event.
  std::error_code error;
  for (fs::directory_iterator entry(folder, error), end; !error && entry != end;
       entry.increment(error)) {
    if (entry->is_directory(error)) {
      add(entry->path(), files);
    } else {
      files.insert(entry->path());
    }
  }
}

void FolderWatch::read_events(std::set<fs::path>& files) {
  alignas(inotify_event) std::array<char, 16 * 1024> buffer;
  for (ssize_t n = 0; (n = read(fd_, buffer.data(), buffer.size())) > 0;) {
    for (ssize_t at = 0; at < n;) {
      const auto* event = reinterpret_cast<const inotify_event*>(buffer.data() + at);
      at += static_cast<ssize_t>(sizeof(inotify_event) + event->len);
      if ((event->mask & IN_Q_OVERFLOW) != 0) watched_.clear();  // all roots are looked at again
      const auto folder = folders_.find(event->wd);
      if (folder == folders_.end()) continue;
      if ((event->mask & IN_IGNORED) != 0) {
        watched_.erase(folder->second);
        folders_.erase(folder);
      } else if ((event->mask & IN_ISDIR) != 0) {
        add(folder->second / event->name, files);
      } else if ((event->mask & IN_CREATE) == 0 && event->len > 0) {
        files.insert(folder->second / event->name);
      }
    }
  }
}

std::set<fs::path> FolderWatch::wait(std::chrono::milliseconds patience) {
  std::set<fs::path> files;
  for (const fs::path& root : roots_) {
    if (!watched_.contains(root)) add(root, files);
  }
  pollfd readable{fd_, POLLIN, 0};
  poll(&readable, 1, files.empty() ? static_cast<int>(patience.count()) : 0);
  read_events(files);
  return files;
}

}  // namespace graspd::console
