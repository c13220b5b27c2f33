#pragma once

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <csignal>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <regex>
#include <string>
#include <vector>

/// The real programs as real processes.
namespace graspd::testing {

struct Finished {
  int exit_code = -1;
  std::string output;  ///< standard output and error, as they came
};

/// Runs a command of the shell to its end.
inline Finished run(const std::string& command) {
  Finished finished;
  // NOLINTNEXTLINE(bugprone-command-processor): the commands are the tests' own.
  FILE* pipe = popen((command + " 2>&1").c_str(), "r");
  if (pipe == nullptr) throw std::runtime_error("popen failed");
  std::array<char, 4096> buffer;
  while (const std::size_t n = fread(buffer.data(), 1, buffer.size(), pipe)) {
    finished.output.append(buffer.data(), n);
  }
  const int status = pclose(pipe);
  if (WIFEXITED(status)) finished.exit_code = WEXITSTATUS(status);
  return finished;
}

/// `grasp_server serve …`, on free ports and without keys unless the arguments say otherwise; ended
/// at the end, if it still runs. Its log goes into `log`, where that is said.
class ServeProcess {
 public:
  explicit ServeProcess(std::vector<std::string> arguments, const std::string& log = {}) {
    const auto say_unless = [&](const std::string& said, const std::vector<std::string>& words) {
      if (std::find(arguments.begin(), arguments.end(), said) != arguments.end()) return;
      arguments.insert(arguments.end(), words.begin(), words.end());
    };
    say_unless("--endpoint", {"--endpoint", "tcp://127.0.0.1:0"});
    say_unless("--control-endpoint", {"--control-endpoint", "tcp://127.0.0.1:0"});
    say_unless("--log-level", {"--log-level", log.empty() ? "warning" : "info"});
    say_unless("--key", {"--insecure"});
    arguments.insert(arguments.begin(), {GRASP_SERVER, "serve"});
    int output[2];
    if (pipe2(output, O_CLOEXEC) != 0) throw std::runtime_error("pipe failed");
    pid_ = fork();
    if (pid_ == 0) {
      dup2(output[1], STDOUT_FILENO);
      if (!log.empty()) dup2(open(log.c_str(), O_CREAT | O_WRONLY, 0600), STDERR_FILENO);
      std::vector<char*> words;
      for (std::string& argument : arguments) words.push_back(argument.data());
      words.push_back(nullptr);
      execv(words[0], words.data());
      _exit(127);
    }
    close(output[1]);
    output_ = output[0];
  }
  ~ServeProcess() {
    if (!reaped_) {
      kill(SIGTERM);
      kill(SIGINT);  // the second signal: at once
      wait();
    }
    close(output_);
  }
  ServeProcess(const ServeProcess&) = delete;
  ServeProcess& operator=(const ServeProcess&) = delete;

  /// Reads the line that says where it listens. \returns false where it ended instead.
  bool wait_ready() {
    static const std::regex line(
        R"(grasp_server ready: data (\S+), control (\S+), [^\n]*?(?:, metrics (\S+)/metrics)?\n)");
    std::string text;
    std::smatch match;
    char byte = 0;
    while (!std::regex_search(text, match, line)) {
      if (read(output_, &byte, 1) != 1) return false;
      text += byte;
    }
    data_endpoint = match[1];
    control_endpoint = match[2];
    http_url = match[3];
    return true;
  }
  pid_t pid() const { return pid_; }
  void kill(int signal) const { ::kill(pid_, signal); }
  /// Waits for its end. \returns the exit code, or minus the signal.
  int wait() {
    int status = 0;
    waitpid(pid_, &status, 0);
    reaped_ = true;
    return WIFEXITED(status) ? WEXITSTATUS(status) : -WTERMSIG(status);
  }
  /// The worker processes.
  std::vector<pid_t> workers() const {
    const auto path = std::filesystem::path("/proc") / std::to_string(pid_) / "task" /
                      std::to_string(pid_) / "children";
    std::ifstream children(path);
    std::vector<pid_t> pids;
    for (pid_t pid = 0; children >> pid;) pids.push_back(pid);
    return pids;
  }

  std::string data_endpoint;
  std::string control_endpoint;
  std::string http_url;  ///< empty where there is no HTTP

 private:
  pid_t pid_ = -1;
  int output_ = -1;
  bool reaped_ = false;
};

}  // namespace graspd::testing
