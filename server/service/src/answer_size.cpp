#include "answer_size.hpp"

#include "graspd/codec/codec.hpp"

namespace graspd::service {
namespace {

constexpr std::size_t kMostOfALongMessage_bytes = 1000;

}  // namespace

std::string encode_within_limit(Answer& answer) {
  std::string encoded = codec::encode_answer(answer);
  if (encoded.size() <= kMaxAnswer_bytes) return encoded;
  auto* plan = std::get_if<PlanAnswer>(&answer.body);
  if (plan == nullptr) {  // an exception's text may be of any length
    answer.message.resize(kMostOfALongMessage_bytes);
    return codec::encode_answer(answer);
  }

  plan->rejected_grasps.clear();
  plan->warnings.push_back("rejected grasps are left out: the answer was too large with them");
  encoded = codec::encode_answer(answer);
  if (encoded.size() <= kMaxAnswer_bytes) return encoded;

  for (Object& object : plan->objects) object.outline_px.clear();
  plan->warnings.push_back("outlines are left out: the answer was too large with them");
  encoded = codec::encode_answer(answer);
  if (encoded.size() <= kMaxAnswer_bytes) return encoded;

  answer.code = Code::kInternal;
  answer.message = fmt::format(
      "the answer takes {} bytes, more than the {} that clients accept; "
      "request fewer parts or grasps",
      encoded.size(), kMaxAnswer_bytes);
  answer.body = std::monostate{};
  return codec::encode_answer(answer);
}

}  // namespace graspd::service
