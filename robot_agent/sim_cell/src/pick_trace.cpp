#include "graspd/sim_cell/pick_trace.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace graspd::sim_cell {
namespace {

/// A jaw that slides down along its part touches it with less.
constexpr double kBrush_n = 5;

bool contains(const std::vector<std::size_t>& parts, std::size_t part) {
  return std::ranges::find(parts, part) != parts.end();
}

bool is_collision(const Touch& touch, std::optional<std::size_t> intended) {
  if (!touch.part) return true;
  if (!touch.is_before_closing) return false;
  return touch.part != intended || touch.force_n > kBrush_n;
}

std::string sentence(const Touch& touch, std::optional<std::size_t> intended) {
  const bool is_intended = touch.part && touch.part == intended;
  const std::string what = is_intended ? "the intended part" : touch.what;
  const std::string_view when = touch.is_before_closing ? "before" : "after";
  const std::string force = touch.force_n > 0 ? fmt::format(", {:.1f} N", touch.force_n) : "";
  return fmt::format("{} {} {} {} closing{}", touch.by, is_intended ? "pressed on" : "touched",
                     what, when, force);
}

}  // namespace

JudgedPick judge(const PickTrace& trace, std::optional<std::size_t> intended) {
  JudgedPick judged;
  for (std::size_t i = 0; i < trace.moved_m.size(); ++i) {
    if (i == intended || contains(trace.lifted, i)) continue;
    judged.others_moved_m = std::max(judged.others_moved_m, trace.moved_m[i]);
  }
  const auto say = [&judged](PickVerdict verdict, std::string why) {
    judged.verdict = verdict;
    judged.why = std::move(why);
    return judged;
  };
  for (const Touch& touch : trace.touches) {
    if (is_collision(touch, intended)) {
      return say(PickVerdict::kCollision, sentence(touch, intended));
    }
  }
  if (trace.lifted.empty()) {
    return say(PickVerdict::kMissed, trace.has_closed ? "nothing was lifted" : "never closed");
  }
  if (!intended || !contains(trace.lifted, *intended)) {
    return say(PickVerdict::kWrongPart, fmt::format("part {} was lifted", trace.lifted.front()));
  }
  if (trace.lifted.size() > 1) {
    return say(PickVerdict::kDouble, fmt::format("{} parts were lifted", trace.lifted.size()));
  }
  if (!contains(trace.placed, *intended)) {
    return say(PickVerdict::kDropped, "lifted, but not in the place box at the end");
  }
  return say(PickVerdict::kSuccess, "");
}

}  // namespace graspd::sim_cell
