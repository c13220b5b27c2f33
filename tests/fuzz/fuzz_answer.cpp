#include "check.hpp"
#include "graspd/codec/codec.hpp"

// The client's decoder of answers.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace graspd;
  const auto answer = codec::decode_answer(fuzz::bytes_of(data, size));
  if (!answer) {
    fuzz::check(answer.error().message.size() > 20, "a refusal has a sentence");
    return 0;
  }
  const std::string again = codec::encode_answer(*answer);
  fuzz::check(codec::decode_answer(fuzz::bytes_of(again)).has_value(),
              "what is taken is taken again");
  return 0;
}
