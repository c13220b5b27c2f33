#include "intake.hpp"

#include <xxhash.h>

#include "graspd/codec/codec.hpp"

namespace graspd::service {
namespace {

Result<void> check_frames(const Message& message) {
  if (message.arrived_n < 2) return invalid("the message has no envelope");
  const zmq::message_t& envelope = message.frames[1];
  if (envelope.empty()) {
    return invalid("the envelope is empty; REQ sockets put an empty frame there: use a DEALER");
  }
  if (envelope.size() > kMaxRequestEnvelope_bytes) {
    return invalid("the envelope has {} bytes; at most {} are read", envelope.size(),
                   kMaxRequestEnvelope_bytes);
  }
  if (message.arrived_n > kMostFrames) {
    return invalid("the message has {} frames; a plan request has 2 (envelope, depth image)",
                   message.arrived_n - 1);
  }
  if (message.arrived_n == kMostFrames && message.frames[2].size() > kMaxPayload_bytes) {
    return invalid("the depth image has {} bytes; at most {} are read", message.frames[2].size(),
                   kMaxPayload_bytes);
  }
  return {};
}

Result<void> check_plan(const PlanCall& call, const Message& message,
                        const std::set<std::string>& part_ids, Door door) {
  if (door == Door::kControl) {
    return invalid("the control endpoint answers health only; send plans to the data endpoint");
  }
  if (message.arrived_n != kMostFrames) {
    return invalid(
        "the depth image is missing; a plan request has 2 frames (envelope, depth image)");
  }
  const std::size_t payload_bytes = message.frames[2].size();
  if (payload_bytes != call.frame.payload_bytes) {
    return invalid("frame.payload_bytes: the envelope says {}, the depth image has {}",
                   call.frame.payload_bytes, payload_bytes);
  }
  for (const RequestedPart& part : call.plan.parts) {
    if (part_ids.contains(part.id)) continue;
    return fail(Code::kUnknownPart, "part '{}' is not in this server's catalogue; it has: {}",
                part.id, fmt::join(part_ids, ", "));
  }
  return {};
}

std::vector<std::string> ids_of(const std::vector<RequestedPart>& parts) {
  std::vector<std::string> ids;
  for (const RequestedPart& part : parts) ids.push_back(part.id);
  return ids;
}

/// Pixels count by the checksum that the request gives of them; a worker refuses any others.
std::uint64_t content_of(Request request) {
  request.id = {};
  request.attempt = 1;
  request.budget_ms = 0;
  const std::string text = codec::encode_request(request);
  return XXH3_64bits(text.data(), text.size());
}

}  // namespace

Incoming take_in(Message message, const std::set<std::string>& part_ids, Door door,
                 const std::optional<std::string>& key_cell) {
  const auto id = [&] {
    const bool readable =
        message.arrived_n >= 2 && message.frames[1].size() <= kMaxRequestEnvelope_bytes;
    return readable ? codec::salvage_request_id(bytes_of(message.frames[1])) : RequestId{};
  };
  const std::string cell = key_cell.value_or("");
  if (auto ok = check_frames(message); !ok) return Refused{id(), cell, ok.error()};
  Result<Request> request = codec::decode_request(bytes_of(message.frames[1]));
  if (!request) return Refused{id(), cell, request.error()};
  if (key_cell && request->cell != *key_cell) {
    return Refused{request->id,
                   cell,
                   {Code::kUnauthenticated,
                    fmt::format("cell: the request says '{}', but it came under the key of '{}'; "
                                "say the cell that the key belongs to, or use that cell's key",
                                request->cell, *key_cell)}};
  }
  if (std::holds_alternative<HealthCall>(request->call)) return HealthQuestion{request->id};

  const auto& call = std::get<PlanCall>(request->call);
  if (auto ok = check_plan(call, message, part_ids, door); !ok) {
    return Refused{request->id, std::move(request->cell), ok.error()};
  }
  PlanJob job;
  job.content = content_of(*request);
  job.id = request->id;
  job.attempt = request->attempt;
  job.cell = std::move(request->cell);
  job.parts = ids_of(call.plan.parts);
  job.record = call.plan.options.record;
  job.frame = call.frame;
  job.budget = std::chrono::milliseconds(request->budget_ms);
  job.envelope = std::move(message.frames[1]);
  job.payload = std::move(message.frames[2]);
  return job;
}

}  // namespace graspd::service
