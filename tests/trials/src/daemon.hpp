#pragma once

#include <sys/types.h>

#include <filesystem>
#include <string>

namespace graspd::trials {

/// A program that runs until the object's end, and no longer than the thread that made it.
class Daemon {
 public:
  /// \param command of the shell, which should `exec` the program \param log for what it says
  Daemon(const std::string& command, const std::filesystem::path& log);
  ~Daemon();
  Daemon(const Daemon&) = delete;
  Daemon& operator=(const Daemon&) = delete;

  /// SIGKILL, and waits for its end.
  void kill();

 private:
  pid_t pid_ = -1;
};

}  // namespace graspd::trials
