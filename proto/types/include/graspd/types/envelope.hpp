#pragma once

#include <fmt/format.h>

#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "graspd/types/answer.hpp"
#include "graspd/types/request.hpp"

namespace graspd {

/// Of `graspd.v1`; PROTOCOL.md has the bytes, and what may change within a version.
inline constexpr std::uint32_t kProtocolVersion = 1;
/// Larger messages are refused before anything of them is decoded.
inline constexpr std::size_t kMaxRequestEnvelope_bytes = 128 * 1024;
inline constexpr std::size_t kMaxPayload_bytes = 1024 * 1024;
inline constexpr std::size_t kMaxAnswer_bytes = 256 * 1024;

/// Random; the same for each attempt of one request.
using RequestId = std::array<std::uint8_t, 16>;

/// As logs, records and file names have it.
inline std::string hexadecimal(const RequestId& id) {
  return fmt::format("{:02x}", fmt::join(id, ""));
}

/// How the payload holds the depth image: little-endian uint16, or RVL (Wilson 2017), without loss.
enum class DepthEncoding { kRaw, kRvl };

template <>
struct EnumNames<DepthEncoding> {
  static constexpr std::string_view what = "depth encoding";
  static constexpr std::pair<DepthEncoding, std::string_view> values[] = {
      {DepthEncoding::kRaw, "raw"}, {DepthEncoding::kRvl, "rvl"}};
};

/// What the envelope says of the depth image, which travels as its own ZeroMQ frame.
struct FrameDescription {
  CameraIntrinsics camera;
  double depth_scale_m = 0.001;
  DepthEncoding encoding = DepthEncoding::kRaw;
  std::uint32_t payload_bytes = 0;
  std::uint32_t payload_crc32 = 0;  ///< CRC-32 as in zlib and PNG
};

/// "Plan this frame", without the frame's bytes.
struct PlanCall {
  FrameDescription frame;
  PlanRequest plan;
};
/// "How are you?"
struct HealthCall {};

/// Whatever comes to a server.
struct Request {
  RequestId id{};
  std::uint32_t attempt = 1;
  std::string cell;
  std::uint32_t budget_ms = 0;  ///< time left when it was sent: no clocks to compare
  std::variant<PlanCall, HealthCall> call;
};

/// What a probe is told: work is wanted by `kReady` alone.
enum class ServerState { kStarting, kReady, kDraining };

template <>
struct EnumNames<ServerState> {
  static constexpr std::string_view what = "server state";
  static constexpr std::pair<ServerState, std::string_view> values[] = {
      {ServerState::kStarting, "starting"},
      {ServerState::kReady, "ready"},
      {ServerState::kDraining, "draining"}};
};

/// Load that a server could not take, and that more servers would.
constexpr bool is_shed(Code code) {
  return code == Code::kBusy || code == Code::kSuperseded || code == Code::kDeadlineExceeded ||
         code == Code::kDraining;
}

/// Defects of a server, which somebody has to look into.
constexpr bool is_broken(Code code) {
  return code == Code::kInternal || code == Code::kRejectedPoison;
}

/// Since the server started.
struct CodeCount {
  Code code = Code::kOk;
  std::uint64_t answers_n = 0;
};
/// Of one stage of the pipeline, since the server started.
struct StageTotal {
  std::string stage;
  std::uint64_t runs_n = 0;
  std::int64_t total_ns = 0;
};

/// How a server is, and what it can plan with.
struct HealthAnswer {
  ServerState state = ServerState::kStarting;
  std::uint32_t workers_n = 0;
  std::uint32_t workers_busy_n = 0;
  std::uint32_t queued_n = 0;
  std::uint64_t answered_n = 0;
  double uptime_s = 0;
  std::vector<std::string> part_ids;
  ServerInfo server;
  std::vector<CodeCount> answers_by_code;  ///< of plan requests
  std::vector<StageTotal> stages;
  std::uint64_t workers_lost_n = 0;
  std::uint64_t memory_bytes = 0;  ///< resident, of the server and its workers
};

/// Any code but OK comes with a message and no body.
struct Answer {
  RequestId id{};
  Code code = Code::kOk;
  std::string message;
  std::uint32_t retry_after_ms = 0;
  std::variant<std::monostate, PlanAnswer, HealthAnswer> body;
};

}  // namespace graspd
