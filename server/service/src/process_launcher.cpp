#include <sys/prctl.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstring>
#include <system_error>

#include "graspd/service/launcher.hpp"

namespace graspd::service {
namespace {

std::string describe(int status) {
  if (WIFSIGNALED(status)) {
    const int signal = WTERMSIG(status);
    return fmt::format("killed by signal {} ({})", signal, strsignal(signal));
  }
  return fmt::format("ended with exit code {}", WEXITSTATUS(status));
}

class WorkerProcess : public WorkerHandle {
 public:
  explicit WorkerProcess(pid_t pid)
      : pid_(pid), pidfd_(static_cast<int>(syscall(SYS_pidfd_open, pid, 0))) {
    if (pidfd_ < 0) {
      const int error = errno;
      end();
      throw std::system_error(error, std::generic_category(), "pidfd_open");
    }
  }
  WorkerProcess(const WorkerProcess&) = delete;
  WorkerProcess& operator=(const WorkerProcess&) = delete;
  ~WorkerProcess() override {
    if (!reason_) end();
    close(pidfd_);
  }

  int exit_fd() const override { return pidfd_; }
  std::optional<std::string> exit_reason() override {
    int status = 0;
    if (!reason_ && waitpid(pid_, &status, WNOHANG) == pid_) reason_ = describe(status);
    return reason_;
  }
  void kill() override {
    if (!reason_) ::kill(pid_, SIGKILL);
  }
  int pid() const override { return pid_; }
  std::string name() const override { return fmt::format("pid {}", pid_); }

 private:
  void end() {
    ::kill(pid_, SIGKILL);
    while (waitpid(pid_, nullptr, 0) < 0 && errno == EINTR) {
    }
  }

  pid_t pid_;
  int pidfd_;
  std::optional<std::string> reason_;
};

// Between fork and exec only calls that are safe in a signal handler.
[[noreturn]] void become_worker(const char* program, char* const* arguments, pid_t parent) {
  // Dies with its parent; where that has happened already, nobody will send the signal.
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  if (getppid() != parent) _exit(1);
  sigset_t none;
  sigemptyset(&none);
  sigprocmask(SIG_SETMASK, &none, nullptr);
  execv(program, arguments);
  constexpr std::string_view kMessage = "grasp_server: cannot execute the worker program\n";
  (void)!write(STDERR_FILENO, kMessage.data(), kMessage.size());
  _exit(127);
}

}  // namespace

std::unique_ptr<WorkerHandle> ProcessLauncher::launch(const std::string& endpoint,
                                                      const std::string& identity) {
  std::vector<std::string> words = words_;
  words.insert(words.end(), {"--endpoint", endpoint, "--identity", identity});
  std::vector<char*> arguments;
  for (std::string& word : words) arguments.push_back(word.data());
  arguments.push_back(nullptr);

  const pid_t parent = getpid();
  const pid_t pid = fork();
  if (pid < 0) throw std::system_error(errno, std::generic_category(), "fork of a worker");
  if (pid == 0) become_worker(program_.c_str(), arguments.data(), parent);
  return std::make_unique<WorkerProcess>(pid);
}

}  // namespace graspd::service
