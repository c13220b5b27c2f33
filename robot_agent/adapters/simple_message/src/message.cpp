#include "message.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

namespace graspd::simple_message {
namespace {

constexpr std::size_t kWordSize = sizeof(Word);
constexpr std::size_t kHeaderWords = 3;
/// Far above any message of the protocol; a length beyond it is something else's bytes.
constexpr Word kMaxLength = 4096;

void put(std::vector<std::byte>& bytes, Word word) {
  for (unsigned shift = 0; shift < 32; shift += 8) {
    bytes.push_back(static_cast<std::byte>(word >> shift & 0xff));
  }
}

Word word_at(const std::vector<std::byte>& bytes, std::size_t index) {
  Word word = 0;
  for (std::size_t i = 0; i < kWordSize; ++i) {
    word |= std::to_integer<Word>(bytes[index * kWordSize + i]) << (8 * i);
  }
  return word;
}

Word word_of(double value) { return std::bit_cast<Word>(static_cast<float>(value)); }

Result<void> expect_words(const Message& message, std::size_t words_n, std::string_view what) {
  if (message.body.size() == words_n) return {};
  return invalid("a {} of {} bytes instead of {}", what, message.body.size() * kWordSize,
                 words_n * kWordSize);
}

}  // namespace

std::vector<std::byte> to_bytes(const Message& message) {
  std::vector<std::byte> bytes;
  put(bytes, static_cast<Word>((kHeaderWords + message.body.size()) * kWordSize));
  for (const Word word : {message.type, message.comm, message.reply}) put(bytes, word);
  for (const Word word : message.body) put(bytes, word);
  return bytes;
}

Result<std::optional<Message>> take_message(std::vector<std::byte>& received) {
  if (received.size() < kWordSize) return std::nullopt;
  const Word length = word_at(received, 0);
  if (length < kHeaderWords * kWordSize || length > kMaxLength || length % kWordSize != 0) {
    return invalid("bytes that are no simple message (a length of {})", length);
  }
  if (received.size() < kWordSize + length) return std::nullopt;
  Message message{word_at(received, 1), word_at(received, 2), word_at(received, 3), {}};
  for (std::size_t i = 1 + kHeaderWords; i <= length / kWordSize; ++i) {
    message.body.push_back(word_at(received, i));
  }
  received.erase(received.begin(),
                 received.begin() + static_cast<std::ptrdiff_t>(kWordSize + length));
  return message;
}

Message to_message(const TrajectoryPoint& point, Comm comm) {
  Message message{kJointTrajectoryPoint, comm, kNoReply, {}};
  message.body.push_back(static_cast<Word>(point.sequence));
  for (Eigen::Index i = 0; i < static_cast<Eigen::Index>(kMaxJoints); ++i) {
    message.body.push_back(word_of(i < point.q_rad.size() ? point.q_rad[i] : 0));
  }
  message.body.push_back(word_of(point.velocity));
  message.body.push_back(word_of(point.duration_s));
  return message;
}

std::vector<TrajectoryPoint> download_of(const agent::JointTrajectory& trajectory,
                                         double full_speed_rad_s) {
  std::vector<TrajectoryPoint> points;
  for (std::size_t i = 1; i < trajectory.size(); ++i) {
    const auto& from = trajectory[i - 1];
    const auto& to = trajectory[i];
    const double duration_s = to.t_s - from.t_s;
    const double speed_rad_s = (to.q_rad - from.q_rad).cwiseAbs().maxCoeff() / duration_s;
    points.push_back({static_cast<std::int32_t>(i), to.q_rad,
                      std::clamp(speed_rad_s / full_speed_rad_s, 0.001, 1.0), duration_s});
  }
  // The arm stands at the first point: nothing is to move there, so its speed and time are those of
  // the next, which no controller divides by in vain.
  TrajectoryPoint first{0, trajectory.front().q_rad, 0.001, 0.1};
  if (!points.empty()) {
    first.velocity = points.front().velocity;
    first.duration_s = points.front().duration_s;
  }
  points.insert(points.begin(), first);
  if (points.size() == 1) points.push_back(first);
  points.front().sequence = kStart;
  points.back().sequence = kEnd;
  return points;
}

Result<JointPosition> read_joint_position(const Message& message, int joints_n) {
  if (auto ok = expect_words(message, 1 + kMaxJoints, "joint position"); !ok) {
    return tl::unexpected(ok.error());
  }
  JointPosition position{static_cast<std::int32_t>(message.body[0]), agent::Joints(joints_n)};
  for (Eigen::Index i = 0; i < position.q_rad.size(); ++i) {
    position.q_rad[i] = std::bit_cast<float>(message.body[static_cast<std::size_t>(1 + i)]);
  }
  if (!position.q_rad.allFinite()) return invalid("a joint position that is not finite");
  return position;
}

Result<Status> read_status(const Message& message) {
  if (auto ok = expect_words(message, 7, "status"); !ok) return tl::unexpected(ok.error());
  const auto field = [&](std::size_t i) { return static_cast<std::int32_t>(message.body[i]); };
  return Status{field(0), field(1), field(2), field(3), field(4), field(5), field(6)};
}

}  // namespace graspd::simple_message
