#include "fake_controller.hpp"

#include <arpa/inet.h>
#include <fcntl.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <bit>
#include <chrono>
#include <cmath>
#include <cstring>
#include <stdexcept>
#include <utility>

namespace graspd::testing {
namespace {

using Words = std::vector<std::int32_t>;

std::int32_t bits(float value) { return std::bit_cast<std::int32_t>(value); }
float number(std::int32_t word) { return std::bit_cast<float>(word); }

int listen_on_loopback(std::uint16_t& port) {
  const int listener = socket(AF_INET, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  auto* any = reinterpret_cast<sockaddr*>(&address);
  socklen_t size = sizeof(address);
  if (bind(listener, any, size) != 0 || listen(listener, 4) != 0 ||
      getsockname(listener, any, &size) != 0) {
    throw std::runtime_error("no port on loopback");
  }
  port = ntohs(address.sin_port);
  return listener;
}

void close_socket(int& socket) {
  if (socket >= 0) close(socket);
  socket = -1;
}

}  // namespace

FakeController::FakeController(std::vector<float> q_rad) : q_rad_(std::move(q_rad)) {
  motion_.listener = listen_on_loopback(motion_.port);
  state_.listener = listen_on_loopback(state_.port);
  thread_ = std::thread([this] { run(); });
}

FakeController::~FakeController() {
  over_ = true;
  thread_.join();
  for (Port* port : {&motion_, &state_}) {
    close_socket(port->connection);
    close_socket(port->listener);
  }
}

std::vector<float> FakeController::joints() const {
  const std::lock_guard lock(mutex_);
  return q_rad_;
}

bool FakeController::is_moving() const {
  const std::lock_guard lock(mutex_);
  return moves_;
}

std::vector<FakeController::Point> FakeController::points() const {
  const std::lock_guard lock(mutex_);
  return points_;
}

void FakeController::run() {
  using Clock = std::chrono::steady_clock;
  auto last = Clock::now();
  while (!over_) {
    pollfd waited[] = {{motion_.connection, POLLIN, 0},
                       {motion_.listener, POLLIN, 0},
                       {state_.listener, POLLIN, 0}};
    poll(waited, 3, 5);
    for (Port* port : {&motion_, &state_}) {
      const int connection = accept4(port->listener, nullptr, nullptr, SOCK_CLOEXEC);
      if (connection < 0) continue;
      close_socket(port->connection);
      port->connection = connection;
    }
    const std::lock_guard lock(mutex_);
    read_motion();
    const auto now = Clock::now();
    advance(std::chrono::duration<double>(now - last).count());
    last = now;
    send_state();
  }
}

void FakeController::read_motion() {
  std::uint8_t bytes[4096];
  const auto n = recv(motion_.connection, bytes, sizeof(bytes), MSG_DONTWAIT);
  if (n == 0) close_socket(motion_.connection);
  if (n > 0) received_.insert(received_.end(), bytes, bytes + n);
  while (received_.size() >= 4) {
    std::int32_t length = 0;
    std::memcpy(&length, received_.data(), 4);  // this machine is little-endian, as the wire is
    const auto size = 4 + static_cast<std::size_t>(length);
    if (received_.size() < size) return;
    Words words(static_cast<std::size_t>(length) / 4);
    std::memcpy(words.data(), received_.data() + 4, words.size() * 4);
    received_.erase(received_.begin(), received_.begin() + static_cast<std::ptrdiff_t>(size));
    take(words);
  }
}

/// words: type, comm, reply; sequence, ten joints, velocity, duration.
void FakeController::take(const Words& words) {
  if (words.size() != 16 || words[0] != 11) return;
  Point point{words[3], {}, number(words[14]), number(words[15])};
  for (std::size_t i = 0; i < q_rad_.size(); ++i) point.q_rad.push_back(number(words[4 + i]));
  if (point.sequence == -4) {
    ++stops_n_;
    if (stop_answer_ == StopAnswer::kConfirms || stop_answer_ == StopAnswer::kOtherSequence) halt();
    if (stop_answer_ == StopAnswer::kNothing) return;
    Words reply = words;
    reply[1] = 3;
    reply[2] = stop_answer_ == StopAnswer::kRefuses ? 2 : 1;
    if (stop_answer_ == StopAnswer::kOtherSequence) reply[3] = 7;
    send(motion_, reply);
    return;
  }
  if (point.sequence == -1) downloading_.clear();
  downloading_.push_back(point);
  if (point.sequence == -3) start_motion();
}

void FakeController::start_motion() {
  points_ = std::exchange(downloading_, {});
  moved_s_ = 0;
  moves_ = !e_stopped_;
  goes_well_ = good_motions_n_ > 0;
  if (goes_well_) --good_motions_n_;
  went_wrong_ = false;
}

void FakeController::advance(double seconds) {
  if (!moves_) return;
  if (e_stopped_) return halt();
  moved_s_ += seconds;
  double planned_s = 0;
  for (std::size_t i = 1; i < points_.size(); ++i) planned_s += points_[i].duration_s;
  const bool is_time = !goes_well_ && moved_s_ >= planned_s / 5;
  if (is_time && !std::exchange(went_wrong_, true)) go_wrong();
  if (!moves_) return;
  double start_s = 0;
  q_rad_ = points_.back().q_rad;
  for (std::size_t i = 1; i < points_.size(); ++i) {
    const double duration_s = points_[i].duration_s;
    if (moved_s_ < start_s + duration_s) {
      const auto share = static_cast<float>((moved_s_ - start_s) / duration_s);
      for (std::size_t joint = 0; joint < q_rad_.size(); ++joint) {
        q_rad_[joint] = std::lerp(points_[i - 1].q_rad[joint], points_[i].q_rad[joint], share);
      }
      return;
    }
    start_s += duration_s;
  }
  moves_ = misbehaviour_ == Misbehaviour::kNeverSettles;
}

void FakeController::go_wrong() {
  switch (misbehaviour_.load()) {
    case Misbehaviour::kVanishes:
      close_socket(motion_.listener);
      close_socket(state_.listener);
      close_socket(state_.connection);
      [[fallthrough]];
    case Misbehaviour::kClosesMotion:
      return close_socket(motion_.connection);
    case Misbehaviour::kClosesState:
      return close_socket(state_.connection);
    case Misbehaviour::kEmergencyStop:
      e_stopped_ = true;
      [[fallthrough]];
    case Misbehaviour::kReportsError:
    case Misbehaviour::kLosesPower:
    case Misbehaviour::kHalts:
      return halt();
    case Misbehaviour::kGarbageOnState:
      return send_bytes(state_, std::vector<std::uint8_t>(64, 0xab));
    case Misbehaviour::kGarbageOnMotion:
      return send_bytes(motion_, std::vector<std::uint8_t>(64, 0xab));
    case Misbehaviour::kWrongLength:
      return send(state_, {10, 1, 0, 0, bits(0.5F)});
    case Misbehaviour::kRefusesPoint:
      return send(motion_, {11, 3, 2});
    case Misbehaviour::kNone:
    case Misbehaviour::kFallsSilent:
    case Misbehaviour::kStopsStatus:
    case Misbehaviour::kCountsBack:
    case Misbehaviour::kNeverSettles:
      return;
  }
}

void FakeController::halt() { moves_ = false; }

void FakeController::send_state() {
  const Misbehaviour fault = went_wrong_ ? misbehaviour_.load() : Misbehaviour::kNone;
  if (fault == Misbehaviour::kFallsSilent) return;
  send(state_, joint_position());
  if (dribbles_) send(state_, {1, 1, 0});
  if (fault != Misbehaviour::kStopsStatus) send(state_, status());
}

Words FakeController::joint_position() {
  const bool numbers = misbehaviour_ == Misbehaviour::kCountsBack;
  if (numbers) sequence_ = went_wrong_ ? 1 : sequence_ + 1;
  Words words{10, 1, 0, sequence_};
  for (std::size_t i = 0; i < 10; ++i) words.push_back(bits(i < q_rad_.size() ? q_rad_[i] : 0));
  return words;
}

/// drives_powered, e_stopped, error_code, in_error, in_motion, mode, motion_possible
Words FakeController::status() const {
  const Misbehaviour fault = went_wrong_ ? misbehaviour_.load() : Misbehaviour::kNone;
  const bool in_error = fault == Misbehaviour::kReportsError;
  return {13,         1,
          0,          fault != Misbehaviour::kLosesPower,
          e_stopped_, in_error ? 1234 : 0,
          in_error,   hides_motion_ ? -1 : moves_,
          2,          !e_stopped_};
}

void FakeController::send(Port& port, const Words& words) {
  Words message{static_cast<std::int32_t>(words.size() * 4)};
  message.insert(message.end(), words.begin(), words.end());
  std::vector<std::uint8_t> bytes(message.size() * 4);
  std::memcpy(bytes.data(), message.data(), bytes.size());
  if (!dribbles_) return send_bytes(port, bytes);
  for (const std::uint8_t byte : bytes) send_bytes(port, {byte});
}

void FakeController::send_bytes(Port& port, const std::vector<std::uint8_t>& bytes) {
  if (port.connection < 0) return;
  const auto sent = ::send(port.connection, bytes.data(), bytes.size(), MSG_NOSIGNAL);
  if (sent < 0) close_socket(port.connection);
}

}  // namespace graspd::testing
