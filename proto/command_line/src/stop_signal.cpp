#include "graspd/command_line/stop_signal.hpp"

#include <signal.h>

#include <initializer_list>

namespace graspd {
namespace {

volatile sig_atomic_t stop = 0;

}  // namespace

void listen_for_stop() {
  struct sigaction action {};
  action.sa_handler = [](int) { stop = 1; };
  for (const int signal : {SIGINT, SIGTERM}) sigaction(signal, &action, nullptr);
}

bool asked_to_stop() { return stop != 0; }

}  // namespace graspd
