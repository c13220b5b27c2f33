#include <google/protobuf/util/json_util.h>

#include <stdexcept>

#include "bytes.hpp"
#include "convert.hpp"
#include "graspd/codec/codec.hpp"

namespace graspd::codec {
namespace {

namespace pb = google::protobuf;

std::string print(const pb::Message& message, bool indented) {
  pb::util::JsonPrintOptions options;
  options.add_whitespace = indented;
  options.preserve_proto_field_names = true;
  // A script that reads a count wants to find the 0.
  options.always_print_primitive_fields = true;
  std::string json;
  const auto status = pb::util::MessageToJsonString(message, &json, options);
  if (!status.ok()) throw std::runtime_error("a message as JSON: " + status.ToString());
  return json;
}

template <class Wire, class T>
std::string print(const T& value, bool indented) {
  Wire message;
  write(value, message);
  return print(message, indented);
}

/// A newer program's fields are passed over, as on the wire.
Result<void> scan(std::string_view json, pb::Message& message) {
  pb::util::JsonParseOptions options;
  options.ignore_unknown_fields = true;
  const auto status = pb::util::JsonStringToMessage({json.data(), json.size()}, &message, options);
  if (status.ok()) return {};
  return invalid("this is no {} as JSON: {}", message.GetDescriptor()->full_name(),
                 status.ToString());
}

}  // namespace

std::string to_json(const PlanRequest& request, bool indented) {
  return print<v1::PlanRequest>(request, indented);
}

std::string to_json(const PlanAnswer& answer, bool indented) {
  return print<v1::PlanAnswer>(answer, indented);
}

std::string to_json(const HealthAnswer& answer, bool indented) {
  return print<v1::HealthAnswer>(answer, indented);
}

Result<PlanAnswer> plan_answer_from_json(std::string_view json) {
  v1::PlanAnswer message;
  if (auto ok = scan(json, message); !ok) return tl::unexpected(ok.error());
  std::optional<Error> refusal;
  PlanAnswer answer = read(message, Field(refusal));
  if (refusal) return tl::unexpected(*refusal);
  return answer;
}

Result<std::string> plan_request_json(Bytes envelope) {
  const auto request = decode_request(envelope);
  if (!request) return tl::unexpected(request.error());
  if (!std::holds_alternative<PlanCall>(request->call)) return invalid("this is no plan request");
  v1::Request message;
  parse(envelope, message);
  return print(message.plan().request(), false);
}

Result<std::string> plan_answer_json(Bytes envelope) {
  const auto answer = decode_answer(envelope);
  if (!answer) return tl::unexpected(answer.error());
  if (!std::holds_alternative<PlanAnswer>(answer->body)) return invalid("this answer has no plan");
  v1::Answer message;
  parse(envelope, message);
  return print(message.plan(), false);
}

Result<std::string> request_from_json(std::string_view plan_request_json,
                                      const FrameDescription& frame) {
  v1::Request message;
  message.set_protocol_version(kProtocolVersion);
  message.set_id(std::string(RequestId{}.size(), '\0'));
  message.set_attempt(1);
  write(frame, *message.mutable_plan()->mutable_frame());
  if (auto ok = scan(plan_request_json, *message.mutable_plan()->mutable_request()); !ok) {
    return tl::unexpected(ok.error());
  }
  std::string envelope = serialize(message);
  const auto readable = decode_request(std::as_bytes(std::span(envelope)));
  if (!readable) return tl::unexpected(readable.error());
  return envelope;
}

}  // namespace graspd::codec
