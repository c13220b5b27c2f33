#include "run_command.hpp"

#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <spawn.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstring>

namespace graspd::output_gripper {
namespace {

using std::chrono::milliseconds;
using std::chrono::steady_clock;

class Descriptor {
 public:
  explicit Descriptor(int number) : number_(number) {}
  ~Descriptor() {
    if (number_ >= 0) close(number_);
  }
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  int number() const { return number_; }

 private:
  int number_;
};

/// Starts the program in a process group of its own, with what it says on stderr into `said`.
int spawn(const std::vector<std::string>& words, int said, pid_t& process) {
  std::vector<char*> arguments;
  for (const std::string& word : words) arguments.push_back(const_cast<char*>(word.c_str()));
  arguments.push_back(nullptr);
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
  posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, "/dev/null", O_WRONLY, 0);
  posix_spawn_file_actions_adddup2(&actions, said, STDERR_FILENO);
  posix_spawnattr_t attributes;
  posix_spawnattr_init(&attributes);
  posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETPGROUP);
  const int error =
      posix_spawnp(&process, arguments[0], &actions, &attributes, arguments.data(), environ);
  posix_spawn_file_actions_destroy(&actions);
  posix_spawnattr_destroy(&attributes);
  return error;
}

/// Whether the process ends before `until`.
bool wait_for_end(pid_t process, steady_clock::time_point until) {
  const Descriptor handle(static_cast<int>(syscall(SYS_pidfd_open, process, 0)));
  while (true) {
    const auto left = std::chrono::ceil<milliseconds>(until - steady_clock::now());
    pollfd waited{handle.number(), POLLIN, 0};
    const int ready_n = poll(&waited, 1, static_cast<int>(std::max(left, milliseconds(0)).count()));
    if (ready_n >= 0 || errno != EINTR) return ready_n > 0;
  }
}

/// \param said does not block: a child left behind may still have its other end.
std::string last_line_of(int said) {
  std::string text;
  char bytes[4096];
  for (ssize_t n = 0; (n = read(said, bytes, sizeof(bytes))) > 0;) {
    text.append(bytes, static_cast<std::size_t>(n));
  }
  while (!text.empty() && text.back() == '\n') text.pop_back();
  return text.substr(text.rfind('\n') + 1);
}

}  // namespace

Result<Finished> run_command(const std::vector<std::string>& words, milliseconds timeout) {
  const auto until = steady_clock::now() + timeout;
  int ends[2];
  if (pipe2(ends, O_CLOEXEC | O_NONBLOCK) != 0) {
    return fail(Code::kUnavailable, "'{}' can't be run: {}", words[0], std::strerror(errno));
  }
  const Descriptor said(ends[0]);
  pid_t process = 0;
  {
    const Descriptor theirs(ends[1]);
    if (const int error = spawn(words, theirs.number(), process)) {
      return fail(Code::kUnavailable, "'{}' can't be run: {}", words[0], std::strerror(error));
    }
  }
  const bool ended = wait_for_end(process, until);
  if (!ended) kill(-process, SIGKILL);
  int status = 0;
  waitpid(process, &status, 0);
  if (!ended) {
    return fail(Code::kUnavailable, "'{}' did not end within {:.1f} s", words[0],
                std::chrono::duration<double>(timeout).count());
  }
  if (WIFSIGNALED(status)) {
    return fail(Code::kUnavailable, "'{}' was ended by signal {}", words[0], WTERMSIG(status));
  }
  return Finished{WEXITSTATUS(status), last_line_of(said.number())};
}

}  // namespace graspd::output_gripper
