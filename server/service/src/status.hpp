#pragma once

#include <mutex>
#include <optional>
#include <string>

#include "graspd/service/fair_queue.hpp"

namespace graspd::service {

/// What the front's thread says of itself once a turn, for the threads of HTTP.
class Status {
 public:
  explicit Status(TimePoint now) : published_(now) {}

  void publish(TimePoint now, std::optional<std::string> why_not_ready) {
    const std::lock_guard lock(mutex_);
    published_ = now;
    why_not_ready_ = std::move(why_not_ready);
  }
  std::optional<std::string> why_not_ready() const {
    const std::lock_guard lock(mutex_);
    return why_not_ready_;
  }
  TimePoint published() const {
    const std::lock_guard lock(mutex_);
    return published_;
  }

 private:
  mutable std::mutex mutex_;
  TimePoint published_;
  std::optional<std::string> why_not_ready_ = "the server is starting";
};

}  // namespace graspd::service
