#include "graspd/agent/pick_cycle.hpp"
#include "stopwatch.hpp"

namespace graspd::agent {

/// One order to arm or gripper: timed, and named where it fails.
template <class Give>
auto PickCycle::order(Step step, const Give& give) {
  const auto start = ports_.clock.now();
  auto result = give();
  still_since_ = ports_.clock.now();
  if (record_) record_->steps.push_back({step, still_since_ - start});
  if (!result) {
    result.error().message = fmt::format("{}: {}", name_of(step), result.error().message);
  }
  return result;
}

Result<void> PickCycle::move(const Motion& motion) {
  return order(motion.step, [&] { return ports_.arm.move(motion); });
}

Result<void> PickCycle::open(Step step, double width_m) {
  return order(step, [&] { return ports_.gripper.open(width_m); });
}

Result<void> PickCycle::close() {
  return order(Step::kClose, [&] { return ports_.gripper.close(); });
}

/// What two readings in a row say. A sensor that contradicts itself twice says nothing.
Result<bool> PickCycle::holds_something() {
  return order(Step::kCheck, [&]() -> Result<bool> {
    for (int tries_n = 0; tries_n < 2; ++tries_n) {
      auto first = ports_.gripper.holds_something();
      if (!first) return first;
      auto second = ports_.gripper.holds_something();
      if (!second || *second == *first) return second;
    }
    return fail(Code::kInternal,
                "the gripper says by turns that it holds something and that it does not; check its "
                "sensor");
  });
}

/// A part that sticks gets a second chance to fall.
Result<void> PickCycle::release(double width_m) {
  for (int tries_n = 0; tries_n < 2; ++tries_n) {
    if (auto opened = open(Step::kRelease, width_m); !opened) return opened;
    const auto holds = holds_something();
    if (!holds) return tl::unexpected(holds.error());
    if (!*holds) return {};
  }
  return fail(Code::kInternal,
              "release: the gripper was opened twice and still holds something; check its fingers "
              "and its sensor");
}

Event PickCycle::clear_view() {
  std::chrono::nanoseconds before_first_frame{};
  const Stopwatch stopwatch(ports_.clock, record_ ? record_->clear_view : before_first_frame);
  const auto cleared = order(Step::kOutOfView, [&] { return ports_.arm.move_out_of_view(); });
  if (!cleared) return fault(cleared.error().message);
  return has_given_up() ? Event::kGivenUp : Event::kCleared;
}

Event PickCycle::pick() {
  const Stopwatch stopwatch(ports_.clock, record_->pick);
  const double width_m = record_->chosen->grasp.opening_width_m;
  // Opened before it dives into the bin: its way was checked with jaws as wide as that.
  const auto held = open(Step::kOpen, width_m)
                        .and_then([&] { return move(motions_.pre_grasp); })
                        .and_then([&] { return move(motions_.approach); })
                        .and_then([&] { return close(); })
                        .and_then([&] { return move(motions_.lift); })
                        .and_then([&] { return holds_something(); });
  if (!held) return fault(held.error().message);
  if (*held) return Event::kHeld;
  return lost(Verdict::kMissed, "the gripper is empty after lifting");
}

Event PickCycle::place() {
  const Stopwatch stopwatch(ports_.clock, record_->place);
  const auto held = move(motions_.transfer).and_then([&] { return holds_something(); });
  if (!held) return fault(held.error().message);
  if (!*held) return lost(Verdict::kDropped, "the gripper is empty after the transfer");
  const double width_m = record_->chosen->grasp.opening_width_m;
  const auto released =
      move(motions_.place).and_then([&] { return release(width_m); }).and_then([&] {
        return move(motions_.retreat);
      });
  if (!released) return fault(released.error().message);
  record_->verdict = Verdict::kPlaced;
  memory_.placed(answer_, record_->chosen->grasp);
  failures_n_ = 0;
  stirs_n_ = 0;
  return Event::kPlaced;
}

/// The first stroke that the arm can make, each time starting with the next direction.
Event PickCycle::stir() {
  const Stopwatch stopwatch(ports_.clock, record_->stir);
  const auto ways = strokes(surroundings_, task_.request.gripper, task_.stir);
  // The parts are meant to be touched; bin and table are not.
  ports_.arm.set_surroundings({surroundings_.bin, {}});
  std::string why_not = "there is no pile, or no room for the gripper beside it";
  for (std::size_t i = 0; i < ways.size(); ++i) {
    const Stroke& stroke = ways[(i + static_cast<std::size_t>(stirs_n_)) % ways.size()];
    if (auto reason = ports_.arm.why_not(stroke)) {
      why_not = *std::move(reason);
      continue;
    }
    ++stirs_n_;
    const auto stirred = close()
                             .and_then([&] { return move(stroke[0]); })
                             .and_then([&] { return move(stroke[1]); })
                             .and_then([&] { return move(stroke[2]); })
                             .and_then([&] { return move(stroke[3]); })
                             .and_then([&] { return drop_what_was_caught(); });
    if (!stirred) return fault(stirred.error().message);
    return Event::kStirred;
  }
  record_->message += fmt::format("; can't stir: {}", why_not);
  reason_ += fmt::format("; can't stir: {}", why_not);
  return Event::kNoStroke;
}

/// Closed jaws that are pressed into a pile can be forced open by a part and grip it. How it lies
/// between them nobody knows: it goes back.
Result<void> PickCycle::drop_what_was_caught() {
  return holds_something().and_then([&](bool holds) -> Result<void> {
    if (!holds) return {};
    return release(task_.request.gripper.max_opening_m);
  });
}

Event PickCycle::lost(Verdict verdict, std::string_view how) {
  record_->verdict = verdict;
  record_->message = how;
  reason_ = fmt::format("{}: {}", name_of(verdict), how);
  memory_.failed(record_->chosen->grasp);
  ++failures_n_;
  return verdict == Verdict::kMissed ? Event::kMissed : Event::kDropped;
}

}  // namespace graspd::agent
