#include "trace_recorder.hpp"

#include <algorithm>

namespace graspd::sim_cell {
namespace {

/// A part that rises by more hangs in the gripper.
constexpr double kLifted_m = 0.05;
/// An arm stops at more: against what gives way, and into what does not.
constexpr double kStall_n = 50;
constexpr double kStall_m = 0.002;

/// One body of the robot against one other: the sum over their contacts.
struct Push {
  const BodyLabel* by = nullptr;
  const BodyLabel* what = nullptr;
  double force_n = 0;
};

void add(const BodyLabel& by, const BodyLabel& what, double force_n, std::vector<Push>& pushes) {
  const auto known = std::ranges::find_if(
      pushes, [&](const Push& push) { return push.by == &by && push.what == &what; });
  if (known == pushes.end()) {
    pushes.push_back({&by, &what, force_n});
  } else {
    known->force_n += force_n;
  }
}

}  // namespace

TraceRecorder::TraceRecorder(const PartBodies& parts) : parts_(parts) { begin(); }

void TraceRecorder::begin() {
  trace_ = {};
  start_m_.clear();
  for (std::size_t i = 0; i < parts_.size(); ++i) start_m_.push_back(parts_.centre_m(i));
}

Resistance TraceRecorder::record(std::span<const simulation::Contact> contacts, double step_s,
                                 bool is_gripping) {
  trace_.duration_s += step_s;
  Resistance worst;
  const auto resists = [&worst](const BodyLabel& by, const BodyLabel& what, double share) {
    if (share > worst.share) worst = {share, by.name, what.name};
  };
  std::vector<Push> pushes;
  for (const simulation::Contact& contact : contacts) {
    const BodyLabel* by = label_of(contact.a);
    const BodyLabel* what = label_of(contact.b);
    if (by == nullptr || what == nullptr) continue;
    if (what->kind == BodyLabel::Kind::kRobot) std::swap(by, what);
    if (by->kind != BodyLabel::Kind::kRobot) continue;
    if (contact.distance_m >= 0 && contact.impulse_n_s <= 0) continue;
    add(*by, *what, contact.impulse_n_s / step_s, pushes);
    const bool gives_way = what->kind == BodyLabel::Kind::kPart;
    if (!gives_way) resists(*by, *what, -contact.distance_m / kStall_m);
  }
  for (const auto& [by, what, force_n] : pushes) {
    Touch& known = touch(*by, *what);
    known.force_n = std::max(known.force_n, force_n);
    const bool is_soft = is_gripping && by->name == "jaw";
    if (!is_soft) resists(*by, *what, force_n / kStall_n);
  }
  if (is_gripping) note_lifted();
  return worst;
}

Touch& TraceRecorder::touch(const BodyLabel& by, const BodyLabel& what) {
  const auto known = std::ranges::find_if(trace_.touches, [&](const Touch& touch) {
    return touch.by == by.name && touch.what == what.name &&
           touch.is_before_closing != trace_.has_closed;
  });
  if (known != trace_.touches.end()) return *known;
  Touch& touch = trace_.touches.emplace_back();
  touch.by = by.name;
  touch.what = what.name;
  if (what.kind == BodyLabel::Kind::kPart) touch.part = what.part;
  touch.is_before_closing = !trace_.has_closed;
  touch.time_s = trace_.duration_s;
  return touch;
}

void TraceRecorder::note_lifted() {
  for (std::size_t i = 0; i < parts_.size(); ++i) {
    if (parts_.is_frozen(i) || parts_.centre_m(i).z() - start_m_[i].z() < kLifted_m) continue;
    if (std::ranges::find(trace_.lifted, i) == trace_.lifted.end()) trace_.lifted.push_back(i);
  }
}

PickTrace TraceRecorder::finish(std::vector<std::size_t> placed) {
  trace_.placed = std::move(placed);
  for (std::size_t i = 0; i < parts_.size(); ++i) {
    trace_.moved_m.push_back((parts_.centre_m(i) - start_m_[i]).norm());
  }
  PickTrace finished = std::move(trace_);
  begin();
  return finished;
}

}  // namespace graspd::sim_cell
