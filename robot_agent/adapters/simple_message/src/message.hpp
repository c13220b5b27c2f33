#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "graspd/agent/joint_driver.hpp"

/// The bytes of simple message: `length | type | comm | reply | body`, every field of 32 bits and
/// little-endian. The length counts what follows it.
namespace graspd::simple_message {

using Word = std::uint32_t;

inline constexpr std::size_t kMaxJoints = 10;  ///< that every message has room for

enum Type : Word { kPing = 1, kJointPosition = 10, kJointTrajectoryPoint = 11, kStatus = 13 };
enum Comm : Word { kTopic = 1, kServiceRequest = 2, kServiceReply = 3 };
enum Reply : Word { kNoReply = 0, kSuccess = 1, kFailure = 2 };

/// Instead of a point's number, in the sequence field.
enum Sequence : std::int32_t { kStart = -1, kEnd = -3, kStop = -4 };

struct Message {
  Word type = kPing;
  Word comm = kTopic;
  Word reply = kNoReply;
  std::vector<Word> body;
};

std::vector<std::byte> to_bytes(const Message& message);

/// Takes the first message off the front of what was received.
/// \returns nothing while it is incomplete; INVALID_ARGUMENT for bytes that are no simple message,
/// after which no later message can be found.
Result<std::optional<Message>> take_message(std::vector<std::byte>& received);

struct TrajectoryPoint {
  std::int32_t sequence = 0;
  agent::Joints q_rad;
  double velocity = 0;    ///< share of the full speed
  double duration_s = 0;  ///< since the last point
};
Message to_message(const TrajectoryPoint& point, Comm comm);

/// The points of a download: topics, the first and the last marked, at least two.
std::vector<TrajectoryPoint> download_of(const agent::JointTrajectory& trajectory,
                                         double full_speed_rad_s);

struct JointPosition {
  std::int32_t sequence = 0;
  agent::Joints q_rad;
};
Result<JointPosition> read_joint_position(const Message& message, int joints_n);

/// Each field is 0, 1 or, where the controller can't say, −1.
struct Status {
  std::int32_t drives_powered = -1;
  std::int32_t e_stopped = -1;
  std::int32_t error_code = 0;
  std::int32_t in_error = -1;
  std::int32_t in_motion = -1;
  std::int32_t mode = -1;
  std::int32_t motion_possible = -1;
};
Result<Status> read_status(const Message& message);

}  // namespace graspd::simple_message
