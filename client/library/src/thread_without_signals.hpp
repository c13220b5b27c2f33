#pragma once

#include <pthread.h>

#include <csignal>
#include <functional>
#include <thread>

namespace graspd::client {

/// Signals are for the program's own threads: one that hits ours would interrupt a socket.
inline std::thread thread_without_signals(std::function<void()> body) {
  sigset_t all;
  sigset_t before;
  sigfillset(&all);
  pthread_sigmask(SIG_SETMASK, &all, &before);
  std::thread thread(std::move(body));
  pthread_sigmask(SIG_SETMASK, &before, nullptr);
  return thread;
}

}  // namespace graspd::client
