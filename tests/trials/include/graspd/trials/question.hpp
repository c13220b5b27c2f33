#pragma once

#include <cstdint>
#include <string>

#include "graspd/types/answer.hpp"
#include "graspd/types/frame.hpp"
#include "graspd/types/request.hpp"

namespace graspd::trials {

/// What a scripted server is asked: its answer says which question it answers.
struct Question {
  std::uint32_t number = 0;
  DepthFrame frame;
  PlanRequest request;
};

/// A frame of 434 KB, as a Kinect v2 makes them, in which the first `number` pixels have no
/// reading. \param script the part that is asked for (service_script.hpp)
Question make_question(std::uint32_t number, const std::string& script);
/// Which question a scripted server has answered.
std::uint32_t question_of(const PlanAnswer& answer);
/// Of everything but times, and of which build said it.
std::uint64_t digest_of(PlanAnswer answer);

}  // namespace graspd::trials
