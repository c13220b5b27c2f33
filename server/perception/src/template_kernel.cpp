#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "template_kernel.cpp"
#include <hwy/foreach_target.h>
// After foreach_target.h, as Highway wants it.
#include <hwy/contrib/math/math-inl.h>
#include <hwy/highway.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <numbers>

#include "graspd/perception/template_kernel.hpp"

HWY_BEFORE_NAMESPACE();
namespace graspd::perception::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using parts::PoseTemplates;

/// Compared less than this many samples, a score means little.
constexpr int kFewSamples = 6;
/// Matches are pruned where there are so many times those that are wanted.
constexpr std::size_t kSlack = 4;

template <class D, class Mask>
std::uint64_t bits_of(D d, Mask mask) {
  std::uint64_t bits = 0;
  hn::StoreMaskBits(d, mask, reinterpret_cast<std::uint8_t*>(&bits));
  return bits;
}

/// Of each template the turns in which its anchor's normal agrees with the reading's. The cosine
/// between them is cos(difference of turns) × product of sines + product of cosines, so that they
/// are a run.
void find_turns(const PoseTemplates& templates, const SampledReading& reading, float min_cosine,
                std::int32_t* first_turn, std::int32_t* turns_n) {
  constexpr float kLeastSine = 1e-6F;
  constexpr float kTurnsPerRadian = PoseTemplates::kTurns / (2 * std::numbers::pi_v<float>);
  const hn::CappedTag<float, PoseTemplates::kReadAhead> d;
  const hn::RebindToSigned<decltype(d)> di;
  const auto one = hn::Set(d, 1.0F);
  for (std::size_t i = 0; i < templates.size(); i += hn::Lanes(d)) {
    const auto sines =
        hn::Mul(hn::LoadU(d, templates.normal_sine.data() + i), hn::Set(d, reading.normal_sine));
    const auto cosines = hn::Mul(hn::LoadU(d, templates.normal_cosine.data() + i),
                                 hn::Set(d, reading.normal_cosine));
    const auto needed =
        hn::Div(hn::Sub(hn::Set(d, min_cosine), cosines), hn::Max(sines, hn::Set(d, kLeastSine)));
    const auto half =
        hn::Mul(hn::Acos(d, hn::Clamp(needed, hn::Neg(one), one)), hn::Set(d, kTurnsPerRadian));
    const auto middle =
        hn::Sub(hn::Set(d, reading.normal_turns), hn::LoadU(d, templates.normal_turns.data() + i));
    const auto first = hn::ConvertTo(di, hn::Ceil(hn::Sub(middle, half)));
    const auto last = hn::ConvertTo(di, hn::Floor(hn::Add(middle, half)));
    const auto count =
        hn::Min(hn::Add(hn::Sub(last, first), hn::Set(di, 1)), hn::Set(di, PoseTemplates::kTurns));
    hn::StoreU(first, di, first_turn + i);
    hn::StoreU(hn::IfThenElseZero(hn::RebindMask(di, hn::Le(needed, one)), count), di, turns_n + i);
  }
}

/// The reading in each turn, so that no load crosses a cache line.
struct TurnedReading {
  explicit TurnedReading(const SampledReading& reading) {
    for (int turn = 0; turn < PoseTemplates::kTurns; ++turn) {
      const int first = PoseTemplates::kRings * turn;
      std::copy_n(reading.depths + first, PoseTemplates::kSamples, depths[turn]);
      has_reading[turn] = std::rotr(reading.has_reading, first);
    }
  }
  alignas(
      PoseTemplates::kSamples) std::int8_t depths[PoseTemplates::kTurns][PoseTemplates::kSamples];
  std::uint64_t has_reading[PoseTemplates::kTurns];
};

/// What a score asks for, without a division for each comparison.
struct LeastExcess {
  explicit LeastExcess(float min_score) {
    // More than what is rounded, less than two scores of so few samples can differ by.
    constexpr float kRounding = 1e-3F;
    for (int compared_n = 0; compared_n <= PoseTemplates::kSamples; ++compared_n) {
      const auto denominator = static_cast<float>(compared_n + kFewSamples);
      of_compared[compared_n] =
          static_cast<std::int32_t>(std::ceil(min_score * denominator - kRounding));
    }
  }
  /// Samples that support less those that refute, by the number of those compared.
  std::int32_t of_compared[PoseTemplates::kSamples + 1];
};

/// Compares with a run of a template's turns. \returns the end of the matches.
TemplateMatch* compare(const PoseTemplates& templates, std::uint32_t index,
                       const TurnedReading& reading, std::uint32_t first_turn,
                       std::uint32_t turns_n, const TemplateLimits& limits,
                       const LeastExcess& least, TemplateMatch* next) {
  const hn::CappedTag<std::int8_t, PoseTemplates::kSamples> d;
  constexpr std::size_t kLanes = hn::MaxLanes(d);
  const auto deeper = hn::Set(d, limits.tolerance);
  const auto nearer = hn::Neg(deeper);
  const std::int8_t* depths =
      templates.depths.data() + PoseTemplates::kSamples * std::size_t{index};
  const std::uint64_t inside = templates.inside[index];
  for (std::uint32_t k = 0; k < turns_n; ++k) {
    // The first may lie below 0, which wraps as well: kTurns divides 2^32.
    const std::uint32_t turn = (first_turn + k) % PoseTemplates::kTurns;
    std::uint64_t behind = 0;
    std::uint64_t in_front = 0;
    for (std::size_t i = 0; i < PoseTemplates::kSamples; i += kLanes) {
      const auto error =
          hn::SaturatedSub(hn::Load(d, reading.depths[turn] + i), hn::LoadU(d, depths + i));
      behind |= bits_of(d, hn::Gt(error, deeper)) << i;
      in_front |= bits_of(d, hn::Lt(error, nearer)) << i;
    }
    const std::uint64_t compared = inside & reading.has_reading[turn];
    const int compared_n = std::popcount(compared);
    const int support_n = std::popcount(compared & ~(behind | in_front));
    const int excess_n = support_n - std::popcount(compared & behind);
    if (excess_n < least.of_compared[compared_n] || support_n < limits.min_support_n) continue;
    *next++ = {static_cast<float>(excess_n) / static_cast<float>(compared_n + kFewSamples), index,
               turn};
  }
  return next;
}

void match_templates(const PoseTemplates& templates, const SampledReading& reading,
                     const TemplateLimits& limits, TemplateMatches& matches) {
  // What is too many is dropped at once, and what is worse than the rest is not kept from then on.
  const std::size_t enough = kSlack * limits.most_n;
  matches.kept.resize(enough + PoseTemplates::kTurns + 1);
  matches.first_turn.resize(templates.size() + PoseTemplates::kReadAhead);
  matches.turns_n.resize(templates.size() + PoseTemplates::kReadAhead);
  matches.compared_n = 0;
  matches.kept_n = 0;
  find_turns(templates, reading, limits.min_cosine, matches.first_turn.data(),
             matches.turns_n.data());
  const TurnedReading turned(reading);
  LeastExcess least(limits.min_score);
  for (std::uint32_t i = 0; i < templates.size(); ++i) {
    const auto turns_n = static_cast<std::uint32_t>(matches.turns_n[i]);
    if (turns_n == 0) continue;
    const TemplateMatch* end =
        compare(templates, i, turned, static_cast<std::uint32_t>(matches.first_turn[i]), turns_n,
                limits, least, matches.kept.data() + matches.kept_n);
    matches.compared_n += turns_n;
    matches.kept_n = static_cast<std::size_t>(end - matches.kept.data());
    if (matches.kept_n > enough) least = LeastExcess(matches.keep_best(limits.most_n));
  }
}

}  // namespace graspd::perception::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace graspd::perception {
namespace {

bool is_better(const TemplateMatch& a, const TemplateMatch& b) { return a.rank() > b.rank(); }

auto at(TemplateMatches& matches, std::size_t i) {
  return matches.kept.begin() + static_cast<std::ptrdiff_t>(i);
}

}  // namespace

float TemplateMatches::keep_best(std::size_t most_n) {
  if (kept_n <= most_n) return 0;
  const auto worst = at(*this, most_n - 1);
  std::nth_element(kept.begin(), worst, at(*this, kept_n), is_better);
  kept_n = most_n;
  return worst->score;
}

void TemplateMatches::sort_best_first() { std::sort(kept.begin(), at(*this, kept_n), is_better); }

HWY_EXPORT(match_templates);
void match_templates(const parts::PoseTemplates& templates, const SampledReading& reading,
                     const TemplateLimits& limits, TemplateMatches& matches) {
  HWY_DYNAMIC_DISPATCH(match_templates)(templates, reading, limits, matches);
  matches.keep_best(limits.most_n);
  matches.sort_best_first();
}
}  // namespace graspd::perception
#endif
