#include "console_operator.hpp"

#include <poll.h>
#include <spdlog/spdlog.h>
#include <unistd.h>

#include <optional>
#include <string>

#include "signals.hpp"

namespace graspd::robot_agent {
namespace {

/// Long enough to cost nothing; a signal that comes between two polls waits no longer.
constexpr int kPoll_ms = 200;

/// Byte by byte, so that nothing that `poll` waits for is held back in a buffer.
/// \returns nothing where the input is closed.
std::optional<std::string> read_line() {
  std::string line;
  for (char c = 0; read(STDIN_FILENO, &c, 1) == 1; line += c) {
    if (c == '\n') return line;
  }
  return std::nullopt;
}

}  // namespace

agent::OperatorSays ConsoleOperator::ask(const std::string& what) {
  told_to_go_on();  // a signal from before the question is no answer
  spdlog::warn("{}", what);
  spdlog::warn("waiting: press Enter or send SIGUSR1 to process {} to go on, type stop to stop",
               getpid());
  while (!asked_to_stop()) {
    if (told_to_go_on()) return agent::OperatorSays::kGoOn;
    pollfd input{STDIN_FILENO, POLLIN, 0};
    // Without input this is a sleep that a signal cuts short.
    if (poll(&input, input_is_open_ ? 1 : 0, kPoll_ms) <= 0) continue;
    const auto line = read_line();
    if (line) return *line == "stop" ? agent::OperatorSays::kStop : agent::OperatorSays::kGoOn;
    input_is_open_ = false;
  }
  return agent::OperatorSays::kStop;
}

}  // namespace graspd::robot_agent
