#include <algorithm>

#include "graspd/agent/pick_cycle.hpp"
#include "stopwatch.hpp"

namespace graspd::agent {
namespace {

/// Whether the same request may fare better a little later. What is wrong in itself stays wrong.
bool is_worth_retrying(Code code) {
  switch (code) {
    case Code::kInvalidArgument:
    case Code::kUnsupportedVersion:
    case Code::kUnauthenticated:
    case Code::kUnknownPart:
      return false;
    default:
      return true;
  }
}

const Object* find_object(const PlanAnswer& answer, std::uint32_t id) {
  const auto found = std::ranges::find(answer.objects, id, &Object::id);
  return found == answer.objects.end() ? nullptr : &*found;
}

}  // namespace

Event PickCycle::plan() {
  PlanRequest request = task_.request;
  memory_.add_to(request);
  PlanReply reply = [&] {
    const Stopwatch stopwatch(ports_.clock, record_->plan);
    return ports_.planner.plan(frame_, request);
  }();
  observer_.planned(record_->frame_n, frame_, request, reply.answer);
  record_->request_id = std::move(reply.request_id);
  unanswered_ = !reply.answer;
  if (!reply.answer) {
    const Error& error = reply.answer.error();
    record_->code = error.code;
    record_->message = error.message;
    reason_ = fmt::format("{}: {}", name_of(error.code), error.message);
    return is_worth_retrying(error.code) ? Event::kNoAnswer : Event::kRefused;
  }
  answer_ = *std::move(reply.answer);
  memory_.planned();
  return answered(request.last_plan.has_value());
}

Event PickCycle::answered(bool last_plan_was_sent) {
  record_->outcome = answer_.outcome;
  record_->message = answer_.reason;
  record_->objects_n = answer_.objects.size();
  record_->grasps_n = answer_.grasps.size();
  record_->server_timings = answer_.timings;
  if (auto alarm = drift_alarm_.see(answer_)) record_->alarm = *std::move(alarm);
  surroundings_ = surveyor_.survey(frame_, task_.request);
  ports_.arm.set_surroundings(surroundings_);
  if (choose_grasp()) return Event::kGrasp;
  memory_.nothing_grasped();
  if (answer_.outcome == Outcome::kUnchanged && last_plan_was_sent) return Event::kNoneStands;
  if (!answer_.grasps.empty()) {
    record_->outcome = Outcome::kNoneReachable;
    record_->message = fmt::format(
        "the arm can take none of {} grasps, the first because {}; check T_base_camera and where "
        "the bin stands",
        answer_.grasps.size(), record_->passed_over.front().reason);
  }
  return react();
}

/// The server's best grasp that the arm can take. Why it can't take those before goes into the
/// record and the next request.
bool PickCycle::choose_grasp() {
  const Stopwatch stopwatch(ports_.clock, record_->choose);
  record_->passed_over.clear();
  for (std::size_t i = 0; i < answer_.grasps.size(); ++i) {
    const Grasp& grasp = answer_.grasps[i];
    const Object* const object = find_object(answer_, grasp.object_id);
    const std::string part_id = object ? object->part_id : "";
    const PickMotions motions = pick_motions(grasp, task_.T_base_place);
    if (const auto why_not = ports_.arm.why_not(motions.all())) {
      memory_.passed_over(grasp, *why_not);
      record_->passed_over.push_back({i + 1, grasp.object_id, part_id, grasp.pick_point, *why_not});
      continue;
    }
    motions_ = motions;
    record_->chosen = {++picks_n_, i + 1, part_id, grasp, object ? object->grs : GrsTerms{}};
    return true;
  }
  return false;
}

/// To an outcome without a grasp, as the cell is configured.
Event PickCycle::react() {
  const Outcome outcome = *record_->outcome;
  reason_ = fmt::format("{}: {}", name_of(outcome), record_->message);
  bin_is_empty_ = outcome == Outcome::kBinEmpty;
  if (bin_is_empty_) memory_.bin_emptied();
  const Reaction reaction = task_.reactions.to(outcome);
  record_->reaction = reaction;
  switch (reaction) {
    case Reaction::kWait:
      return Event::kShallWait;
    case Reaction::kAsk:
      return Event::kShallAsk;
    case Reaction::kStir:
      if (stirs_n_ < task_.stir.max_in_a_row_n) return Event::kShallStir;
      reason_ = fmt::format("stirred {} times in a row, and still {}", stirs_n_, reason_);
      record_->reaction = Reaction::kStop;
      return Event::kShallStop;
    case Reaction::kStop:
      break;
  }
  return bin_is_empty_ ? Event::kBinEmpty : Event::kShallStop;
}

}  // namespace graspd::agent
