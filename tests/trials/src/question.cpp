#include "graspd/trials/question.hpp"

#include <algorithm>
#include <functional>

#include "client_support.hpp"
#include "graspd/codec/codec.hpp"

namespace graspd::trials {

Question make_question(std::uint32_t number, const std::string& script) {
  Question question{number, example_frame(512, 424), example_request({script})};
  std::fill_n(question.frame.depth.begin(), number, std::uint16_t{0});
  if (number == 0) question.frame.depth[0] = 700;
  return question;
}

std::uint32_t question_of(const PlanAnswer& answer) {
  return answer.funnel.pixels_n - answer.funnel.readings_n;
}

std::uint64_t digest_of(PlanAnswer answer) {
  answer.timings.clear();
  Answer envelope;
  envelope.body = std::move(answer);
  return std::hash<std::string>{}(codec::encode_answer(envelope));
}

}  // namespace graspd::trials
