#include "check.hpp"
#include "rvl.hpp"

// The decoder of RVL: the first two bytes are the number of pixels.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace graspd;
  if (size < 2) return 0;
  const std::size_t pixels_n = data[0] | std::size_t{data[1]} << 8;
  const auto depth = codec::rvl_decode(fuzz::bytes_of(data + 2, size - 2), pixels_n);
  if (!depth) return 0;
  fuzz::check(depth->size() == pixels_n, "an image has its number of pixels");
  const auto again = codec::rvl_decode(codec::rvl_encode(*depth), pixels_n);
  fuzz::check(again && *again == *depth, "the code loses nothing");
  return 0;
}
