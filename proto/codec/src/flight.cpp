#include "bytes.hpp"
#include "convert.hpp"
#include "crc32.hpp"
#include "graspd/codec/codec.hpp"
#include "graspd/v1/flight.pb.h"

namespace graspd::codec {
namespace {

Bytes bytes_of(const std::string& text) { return std::as_bytes(std::span(text)); }

std::uint32_t content_crc32(const v1::FlightRecord& record) {
  std::uint32_t crc32 = 0;
  for (const std::string* part : {&record.request(), &record.depth_image(), &record.answer()}) {
    crc32 = crc32_of(bytes_of(*part), crc32);
  }
  return crc32;
}

}  // namespace

std::string encode_flight(const FlightRecord& record) {
  v1::FlightRecord message;
  message.set_cell(record.cell);
  message.set_stamp_s(record.stamp_s);
  write(record.server, *message.mutable_server());
  message.set_request(record.request);
  message.set_depth_image(record.depth_image);
  message.set_answer(record.answer);
  message.set_crc32(content_crc32(message));
  return serialize(message);
}

Result<FlightRecord> decode_flight(Bytes file) {
  v1::FlightRecord message;
  if (file.size() > kMaxFlightRecord_bytes || !parse(file, message) || !message.has_server()) {
    return invalid("these {} bytes are no flight record, or one that was cut short", file.size());
  }
  if (message.crc32() != content_crc32(message)) {
    return invalid("the flight record is damaged: its CRC-32 is {:#010x}, not {:#010x}",
                   content_crc32(message), message.crc32());
  }
  std::optional<Error> refusal;
  const Field top(refusal);
  FlightRecord record;
  record.cell = top("cell").name(message.cell());
  record.stamp_s = top("stamp_s").number(message.stamp_s());
  const Field server = top("server");
  record.server = read(message.server(), server);
  if (refusal) return tl::unexpected(*refusal);
  record.request = std::move(*message.mutable_request());
  record.depth_image = std::move(*message.mutable_depth_image());
  record.answer = std::move(*message.mutable_answer());
  return record;
}

}  // namespace graspd::codec
