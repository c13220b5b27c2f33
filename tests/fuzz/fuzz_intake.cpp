#include "check.hpp"
#include "intake.hpp"

// The front's look at a message: the envelope with no, one and two frames behind it, at both doors.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace graspd::service;
  for (const Door door : {Door::kData, Door::kControl}) {
    for (std::size_t frames_n = 2; frames_n <= 4; ++frames_n) {
      Message message;
      message.arrived_n = frames_n;
      message.frames.push_back(frame_of("a client"));
      message.frames.emplace_back(data, size);
      if (frames_n > 2) message.frames.push_back(frame_of("0123456789abcdef"));
      const Incoming incoming = take_in(std::move(message), {"tee", "elbow"}, door, std::nullopt);
      const auto* plan = std::get_if<PlanJob>(&incoming);
      if (plan == nullptr) continue;
      graspd::fuzz::check(door == Door::kData && frames_n == 3, "a plan is two frames, for data");
      graspd::fuzz::check(plan->payload.size() == plan->frame.payload_bytes, "sizes agree");
    }
  }
  return 0;
}
