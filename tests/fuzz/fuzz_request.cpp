#include "check.hpp"
#include "graspd/codec/codec.hpp"

// The server's decoder of envelopes. A refusal is a sentence; what is taken is taken again.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace graspd;
  const auto request = codec::decode_request(fuzz::bytes_of(data, size));
  if (!request) {
    fuzz::check(request.error().message.size() > 20, "a refusal has a sentence");
    codec::salvage_request_id(fuzz::bytes_of(data, size));
    return 0;
  }
  const std::string again = codec::encode_request(*request);
  fuzz::check(codec::decode_request(fuzz::bytes_of(again)).has_value(),
              "what is taken is taken again");
  return 0;
}
