#pragma once

#include <chrono>
#include <cstdint>
#include <optional>
#include <set>
#include <string>
#include <variant>
#include <vector>

#include "graspd/types/envelope.hpp"
#include "messages.hpp"

namespace graspd::service {

/// A well-formed plan request. Its envelope has been read; its depth image has not been touched.
struct PlanJob {
  RequestId id{};
  std::uint32_t attempt = 1;
  std::string cell;
  std::vector<std::string> parts;
  bool record = false;  ///< the flight recorder is to keep it
  FrameDescription frame;
  std::chrono::milliseconds budget{0};
  /// The same for the same question of the same cell, whatever its id, attempt and budget.
  std::uint64_t content = 0;
  zmq::message_t envelope;
  zmq::message_t payload;
};

struct HealthQuestion {
  RequestId id{};
};

struct Refused {
  RequestId id{};
  std::string cell;  ///< the key's; without keys the request's, where it could be read
  Error error;
};

using Incoming = std::variant<PlanJob, HealthQuestion, Refused>;

enum class Door { kData, kControl };

/// How many frames of a message are looked at; any more make it wrong.
inline constexpr std::size_t kMostFrames = 3;

/// The checks of the admission order that need nothing but the message: number and sizes of its
/// frames, then the envelope, then whose it is, then the parts.
/// \param message [routing id][envelope][payload]
/// \param key_cell the cell whose key it came under, where there are keys
Incoming take_in(Message message, const std::set<std::string>& part_ids, Door door,
                 const std::optional<std::string>& key_cell);

}  // namespace graspd::service
