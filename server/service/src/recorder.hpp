#pragma once

#include <filesystem>
#include <string>
#include <zmq.hpp>

#include "graspd/types/envelope.hpp"

namespace graspd::service {

/// Keeps requests that failed as they came, for `grasp replay`: ID.request, the envelope, and
/// ID.depth, the depth image as sent. Readable by this user alone.
class Recorder {
 public:
  static constexpr std::size_t kMost_n = 100;

  /// \param folder is made with the first request; empty: nothing is kept
  explicit Recorder(std::filesystem::path folder) : folder_(std::move(folder)) {}

  bool is_on() const { return !folder_.empty(); }
  /// Where there are kMost_n, the oldest goes. \returns the path of ID.request, or a sentence that
  /// says why it could not be kept.
  Result<std::filesystem::path> keep(const RequestId& id, const zmq::message_t& envelope,
                                     const zmq::message_t& payload) const;

 private:
  std::filesystem::path folder_;
};

}  // namespace graspd::service
