#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "graspd/types/envelope.hpp"

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

}  // namespace graspd::codec
