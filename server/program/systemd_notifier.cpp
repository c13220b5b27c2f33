#include "systemd_notifier.hpp"

#include <systemd/sd-daemon.h>

namespace graspd::program {
namespace {

const char* message_of(service::Phase phase) {
  switch (phase) {
    case service::Phase::kStarting:
      return "STATUS=waiting for the workers";
    case service::Phase::kReady:
      return "READY=1\nSTATUS=serving";
    case service::Phase::kReloading:
      return "RELOADING=1\nSTATUS=serving, and reading cells and parts again";
    case service::Phase::kDraining:
      return "STOPPING=1\nSTATUS=finishing what was accepted";
  }
  return "";
}

}  // namespace

SystemdNotifier::SystemdNotifier() {
  std::uint64_t watchdog_us = 0;
  // Half of what it allows: one message late is not yet a restart.
  if (sd_watchdog_enabled(0, &watchdog_us) > 0) {
    alive_every_ = std::chrono::microseconds(watchdog_us / 2);
  }
}

void SystemdNotifier::tell(service::Phase phase) {
  if (told_ != phase) {
    told_ = phase;
    sd_notify(0, message_of(phase));
  }
  const Clock::time_point now = Clock::now();
  if (alive_every_.count() > 0 && now - alive_told_ >= alive_every_) {
    alive_told_ = now;
    sd_notify(0, "WATCHDOG=1");
  }
}

}  // namespace graspd::program
