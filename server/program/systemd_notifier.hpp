#pragma once

#include <chrono>
#include <optional>

#include "graspd/service/front.hpp"

namespace graspd::program {

/// Tells systemd, where it has started this server, what the server is at and that its loop turns
/// (sd_notify(3), sd_watchdog_enabled(3)). Elsewhere it does nothing.
class SystemdNotifier {
 public:
  SystemdNotifier();
  /// To be called on every turn of the loop.
  void tell(service::Phase phase);

 private:
  using Clock = std::chrono::steady_clock;

  std::optional<service::Phase> told_;
  std::chrono::microseconds alive_every_{0};  ///< 0: there is no watchdog
  Clock::time_point alive_told_;
};

}  // namespace graspd::program
