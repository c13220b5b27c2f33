#include "signals.hpp"

#include <signal.h>

#include <initializer_list>

namespace graspd::robot_agent {
namespace {

volatile sig_atomic_t stop = 0;
volatile sig_atomic_t go_on = 0;

}  // namespace

void listen_for_signals() {
  struct sigaction action {};
  action.sa_handler = [](int signal) { (signal == SIGUSR1 ? go_on : stop) = 1; };
  for (const int signal : {SIGINT, SIGTERM, SIGUSR1}) sigaction(signal, &action, nullptr);
}

bool asked_to_stop() { return stop != 0; }

bool told_to_go_on() {
  const bool told = go_on != 0;
  go_on = 0;
  return told;
}

}  // namespace graspd::robot_agent
