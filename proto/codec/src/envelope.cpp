#include <algorithm>

#include "bytes.hpp"
#include "convert.hpp"
#include "graspd/codec/codec.hpp"
#include "valid_utf8.hpp"
#include "wire_enums.hpp"

namespace graspd::codec {
namespace {

namespace pb = google::protobuf;

Result<void> parse_envelope(Bytes envelope, std::size_t max_bytes, std::string_view if_too_large,
                            pb::Message& message) {
  const std::string_view type = message.GetDescriptor()->full_name();
  if (envelope.size() > max_bytes) {
    return invalid("the {} has {} bytes; at most {} are taken: {}", type, envelope.size(),
                   max_bytes, if_too_large);
  }
  if (!parse(envelope, message)) {
    return invalid(
        "these {} bytes are no {}; the depth image is a ZeroMQ frame of its own, after it",
        envelope.size(), type);
  }
  return {};
}

std::string id_bytes(const RequestId& id) { return {id.begin(), id.end()}; }

RequestId read_id(const std::string& bytes, const Field& at) {
  RequestId id{};
  if (bytes.size() != id.size()) {
    at.refuse("{} bytes; an id has {}", bytes.size(), id.size());
  } else {
    std::copy(bytes.begin(), bytes.end(), id.begin());
  }
  return id;
}

PlanCall read(const v1::PlanCall& in, const Field& at) {
  return {.frame = read(in.frame(), at("frame").required(in.has_frame())),
          .plan = read(in.request(), at("request").required(in.has_request()))};
}

Request read(const v1::Request& in, const Field& at) {
  Request request;
  request.id = read_id(in.id(), at("id"));
  request.attempt = in.attempt();
  if (request.attempt == 0) at("attempt").refuse("0; the first attempt is 1");
  request.cell = at("cell").name(in.cell());
  request.budget_ms = in.budget_ms();
  if (in.has_plan()) {
    request.call = read(in.plan(), at("plan"));
  } else if (in.has_health()) {
    request.call = HealthCall{};
  } else {
    at("call").refuse("missing; one of plan and health is required");
  }
  return request;
}

Answer read(const v1::Answer& in, const Field& at) {
  Answer answer;
  answer.id = read_id(in.id(), at("id"));
  answer.code = from_wire<Code>(in.code(), at("code"));
  answer.message = in.message();
  answer.retry_after_ms = in.retry_after_ms();
  if (in.has_plan()) answer.body = codec::read(in.plan(), at("plan"));
  if (in.has_health()) answer.body = codec::read(in.health(), at("health"));
  const bool has_body = in.body_case() != v1::Answer::BODY_NOT_SET;
  if ((answer.code == Code::kOk) != has_body) {
    at("body").refuse("{} with code {}; OK has a body, and no other code has",
                      has_body ? "given" : "missing", name_of(answer.code));
  }
  if (answer.code != Code::kOk && answer.message.empty()) {
    at("message").refuse("empty; code {} needs a sentence", name_of(answer.code));
  }
  return answer;
}

}  // namespace

std::string encode_request(const Request& request) {
  v1::Request message;
  message.set_protocol_version(kProtocolVersion);
  message.set_id(id_bytes(request.id));
  message.set_attempt(request.attempt);
  message.set_cell(request.cell);
  message.set_budget_ms(request.budget_ms);
  if (const auto* call = std::get_if<PlanCall>(&request.call)) {
    write(call->frame, *message.mutable_plan()->mutable_frame());
    write(call->plan, *message.mutable_plan()->mutable_request());
  } else {
    message.mutable_health();
  }
  return serialize(message);
}

Result<Request> decode_request(Bytes envelope) {
  v1::Request message;
  if (auto ok = parse_envelope(envelope, kMaxRequestEnvelope_bytes,
                               "send fewer last_plan.objects and failed_spots", message);
      !ok) {
    return tl::unexpected(ok.error());
  }
  if (message.protocol_version() != kProtocolVersion) {
    return fail(Code::kUnsupportedVersion, "protocol_version: {}; this server speaks {}",
                message.protocol_version(), kProtocolVersion);
  }
  std::optional<Error> refusal;
  Request request = read(message, Field(refusal));
  if (refusal) return tl::unexpected(*refusal);
  return request;
}

std::string encode_answer(const Answer& answer) {
  v1::Answer message;
  message.set_protocol_version(kProtocolVersion);
  message.set_id(id_bytes(answer.id));
  message.set_code(to_wire(answer.code));
  message.set_message(answer.message);
  message.set_retry_after_ms(answer.retry_after_ms);
  if (const auto* plan = std::get_if<PlanAnswer>(&answer.body)) {
    write(*plan, *message.mutable_plan());
  } else if (const auto* health = std::get_if<HealthAnswer>(&answer.body)) {
    write(*health, *message.mutable_health());
  }
  make_strings_valid_utf8(message);
  return serialize(message);
}

Result<Answer> decode_answer(Bytes envelope) {
  const auto broken = [](const Error& error) {
    return fail(Code::kInternal, "broken answer: {}", error.message);
  };
  v1::Answer message;
  if (auto ok = parse_envelope(envelope, kMaxAnswer_bytes,
                               "ask without outlines and explain_rejected", message);
      !ok) {
    return broken(ok.error());
  }
  // A server of another version says so in the header, which all versions share.
  if (message.protocol_version() != kProtocolVersion &&
      message.code() != v1::Answer::UNSUPPORTED_VERSION) {
    return fail(Code::kInternal, "broken answer: protocol_version: {}; this client speaks {}",
                message.protocol_version(), kProtocolVersion);
  }
  std::optional<Error> refusal;
  Answer answer = read(message, Field(refusal));
  if (refusal) return broken(*refusal);
  return answer;
}

Result<std::string> with_header(Bytes envelope, const RequestHeader& header) {
  v1::Request message;
  if (!parse(envelope, message)) return invalid("these {} bytes are no request", envelope.size());
  message.set_id(id_bytes(header.id));
  message.set_attempt(header.attempt);
  message.set_cell(header.cell);
  message.set_budget_ms(header.budget_ms);
  return serialize(message);
}

RequestId salvage_request_id(Bytes envelope) {
  v1::Request message;
  // Where parsing fails, the id has been read: it stands at the front.
  parse(envelope.first(std::min(envelope.size(), kMaxRequestEnvelope_bytes)), message);
  RequestId id{};
  if (message.id().size() == id.size()) {
    std::copy(message.id().begin(), message.id().end(), id.begin());
  }
  return id;
}

}  // namespace graspd::codec
