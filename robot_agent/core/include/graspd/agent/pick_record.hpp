#pragma once

#include <chrono>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "graspd/agent/motions.hpp"
#include "graspd/agent/reactions.hpp"
#include "graspd/types/answer.hpp"
#include "graspd/types/frame.hpp"
#include "graspd/types/request.hpp"
#include "graspd/types/result.hpp"

namespace graspd::agent {

/// What became of a grasp, as far as arm and gripper can tell.
enum class Verdict {
  kPlaced,   ///< held after lifting and after the transfer, and put down
  kMissed,   ///< nothing between the fingers after lifting
  kDropped,  ///< lost on the way
  kFault,    ///< arm or gripper reported an error
};

/// The grasp the agent chose.
struct ChosenGrasp {
  std::uint64_t pick_n = 0;  ///< counted from 1: frames without a grasp are no picks
  std::size_t rank = 0;      ///< 1 is the server's best; higher where better ones are out of reach
  std::string part_id;
  Grasp grasp;
  GrsTerms grs;
};

/// A grasp that the arm could not take.
struct PassedOver {
  std::size_t rank = 0;  ///< 1 is the server's best
  std::uint32_t object_id = 0;
  std::string part_id;
  std::string pick_point;
  std::string reason;  ///< a sentence
};

struct StepTiming {
  Step step = Step::kPreGrasp;
  std::chrono::nanoseconds duration{};
};

/// One frame's story, complete when the cycle is ready for the next frame or has ended.
struct PickRecord {
  std::uint64_t frame_n = 0;         ///< counted from 0
  std::chrono::nanoseconds start{};  ///< on the cell's clock, before the frame was asked for
  std::chrono::nanoseconds end{};
  std::string request_id;
  Code code = Code::kOk;           ///< of the answer, or why there was none
  std::optional<Outcome> outcome;  ///< where there was an answer
  std::string message;             ///< a sentence for everything but a part that was placed
  std::string alarm;               ///< a sentence, where this frame raised the drift alarm
  std::size_t objects_n = 0;
  std::size_t grasps_n = 0;
  std::vector<PassedOver> passed_over;  ///< by rank
  std::optional<ChosenGrasp> chosen;
  std::optional<Verdict> verdict;
  std::optional<Reaction> reaction;  ///< where there was nothing to pick
  std::chrono::nanoseconds acquire{};
  std::chrono::nanoseconds plan{};    ///< as the agent waited for it: network and queue included
  std::chrono::nanoseconds choose{};  ///< the arm's search for the first grasp that it can take
  std::chrono::nanoseconds pick{};
  std::chrono::nanoseconds place{};
  std::chrono::nanoseconds stir{};
  std::chrono::nanoseconds clear_view{};
  std::vector<StepTiming> steps;  ///< what pick, place, stir and clear_view are made of, in order
  std::vector<StageTiming> server_timings;
};

/// Sees all that happens, and has no say in it.
class Observer {
 public:
  virtual ~Observer() = default;
  /// A plan was asked for, and this is what came of it; twice for a frame whose last plan stood,
  /// but was out of reach. \param frame_n as in the record that follows.
  virtual void planned(std::uint64_t frame_n, const DepthFrame& frame, const PlanRequest& request,
                       const Result<PlanAnswer>& answer) = 0;
  /// The frame's story is complete.
  virtual void finished(const PickRecord& record) = 0;
};

}  // namespace graspd::agent

template <>
struct graspd::EnumNames<graspd::agent::Verdict> {
  using Verdict = agent::Verdict;
  static constexpr std::string_view what = "verdict";
  static constexpr std::pair<Verdict, std::string_view> values[] = {{Verdict::kPlaced, "PLACED"},
                                                                    {Verdict::kMissed, "MISSED"},
                                                                    {Verdict::kDropped, "DROPPED"},
                                                                    {Verdict::kFault, "FAULT"}};
};
