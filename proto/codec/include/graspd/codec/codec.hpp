#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "graspd/types/envelope.hpp"
#include "graspd/types/flight.hpp"

/// The one place where plain types become bytes of `graspd.v1` and back. PROTOCOL.md describes the
/// bytes. Everything that comes in is checked here; what a decoder returns is well-formed.
namespace graspd::codec {

using Bytes = std::span<const std::byte>;

/// The same message is always the same bytes. Takes what it is given: a request that `validate`
/// refuses is refused by the server.
std::string encode_request(const Request& request);
/// Checks sizes before parsing, the protocol version, every enumeration, count, number and pose.
/// \returns INVALID_ARGUMENT or UNSUPPORTED_VERSION, with the field's name, its value, and what
/// would be right.
Result<Request> decode_request(Bytes envelope);

/// Takes what it is given, even above kMaxAnswer_bytes; bytes that are no UTF-8 become U+FFFD,
/// since no client could read the answer with them. Throws std::invalid_argument for UNAVAILABLE,
/// which never crosses the wire.
std::string encode_answer(const Answer& answer);
/// \returns INTERNAL where the answer is not one of `graspd.v1`.
Result<Answer> decode_answer(Bytes envelope);

/// The request id, and nothing else, of an envelope that `decode_request` refused, so that even the
/// refusal can be matched to its request. All zeros where it can't be read.
RequestId salvage_request_id(Bytes envelope);

/// A depth image ready to be sent: the description goes into the envelope, the payload is its own
/// ZeroMQ frame.
struct EncodedFrame {
  FrameDescription description;
  std::vector<std::byte> payload;
};
/// Raw is little-endian uint16, row by row. RVL of an image that it would make larger is sent raw.
EncodedFrame encode_frame(const DepthFrame& frame, DepthEncoding encoding);
/// \returns INVALID_ARGUMENT where the payload's size or checksum differs from the description, or
/// the frame fails `validate`.
Result<DepthFrame> decode_frame(const FrameDescription& description, Bytes payload);

/// For people and scripts: protobuf's JSON, one line or indented.
std::string to_json(const PlanRequest& request, bool indented);
std::string to_json(const PlanAnswer& answer, bool indented);
std::string to_json(const HealthAnswer& answer, bool indented);
/// \returns INVALID_ARGUMENT where the text is not what `to_json` prints of an answer.
Result<PlanAnswer> plan_answer_from_json(std::string_view json);

// What is asked again, and what an answer is compared with, must be the same to the bit. By way of
// our types it would not be: a pose is a quaternion on the wire and a matrix there, and its last
// bits change in between.

/// The plan request of an envelope, in one line.
/// \returns what `decode_request` refuses it for; INVALID_ARGUMENT where it asks for something
/// else.
Result<std::string> plan_request_json(Bytes envelope);
/// The same of an answer.
Result<std::string> plan_answer_json(Bytes envelope);
/// The envelope of a plan request for this frame; its header is to be filled in.
/// \returns INVALID_ARGUMENT where `decode_request` would refuse it.
Result<std::string> request_from_json(std::string_view plan_request_json,
                                      const FrameDescription& frame);

/// What of an envelope changes from one attempt to the next.
struct RequestHeader {
  RequestId id{};
  std::uint32_t attempt = 1;
  std::string cell;
  std::uint32_t budget_ms = 0;
};
/// The same request under another header.
Result<std::string> with_header(Bytes envelope, const RequestHeader& header);

/// More than that is no flight record.
inline constexpr std::size_t kMaxFlightRecord_bytes =
    kMaxRequestEnvelope_bytes + kMaxPayload_bytes + kMaxAnswer_bytes + 4096;

/// With a checksum over request, image and answer.
std::string encode_flight(const FlightRecord& record);
/// What the record holds has been neither cut nor damaged, and is yet to be decoded.
/// \returns INVALID_ARGUMENT
Result<FlightRecord> decode_flight(Bytes file);

}  // namespace graspd::codec
