#include "signals.hpp"

#include <signal.h>

namespace graspd::robot_agent {
namespace {

volatile sig_atomic_t go_on = 0;

}  // namespace

void listen_for_signals() {
  listen_for_stop();
  struct sigaction action {};
  action.sa_handler = [](int) { go_on = 1; };
  sigaction(SIGUSR1, &action, nullptr);
}

bool told_to_go_on() {
  const bool told = go_on != 0;
  go_on = 0;
  return told;
}

}  // namespace graspd::robot_agent
