#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "template_kernel.cpp"
#include <hwy/foreach_target.h>
// After foreach_target.h, as Highway wants it.
#include <hwy/highway.h>

#include <bit>

#include "graspd/perception/template_kernel.hpp"

HWY_BEFORE_NAMESPACE();
namespace graspd::perception::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using parts::PoseTemplates;

/// Compared less than this many samples, a score means little.
constexpr int kFewSamples = 6;

template <class D, class Mask>
std::uint64_t bits_of(D d, Mask mask) {
  std::uint64_t bits = 0;
  hn::StoreMaskBits(d, mask, reinterpret_cast<std::uint8_t*>(&bits));
  return bits;
}

/// The templates whose anchor's normal agrees with the reading's in this turn. \returns how many.
std::size_t find_candidates(const PoseTemplates& templates, const SampledReading& reading,
                            std::size_t turn, float min_cosine, std::uint32_t* candidates) {
  const hn::CappedTag<float, PoseTemplates::kReadAhead> d;
  const hn::RebindToUnsigned<decltype(d)> du;
  const auto x = hn::Set(d, reading.nx[turn]);
  const auto y = hn::Set(d, reading.ny[turn]);
  const auto z = hn::Set(d, reading.nz[turn]);
  std::uint32_t* next = candidates;
  for (std::size_t i = 0; i < templates.size(); i += hn::Lanes(d)) {
    const auto cosine = hn::MulAdd(x, hn::LoadU(d, templates.nx.data() + i),
                                   hn::MulAdd(y, hn::LoadU(d, templates.ny.data() + i),
                                              hn::Mul(z, hn::LoadU(d, templates.nz.data() + i))));
    const auto agrees =
        hn::And(hn::Ge(cosine, hn::Set(d, min_cosine)), hn::FirstN(d, templates.size() - i));
    // Not CompressStore: to memory, some processors compress a hundred times slower.
    const auto indices = hn::Iota(du, static_cast<std::uint32_t>(i));
    hn::StoreU(hn::Compress(indices, hn::RebindMask(du, agrees)), du, next);
    next += hn::CountTrue(d, agrees);
  }
  return static_cast<std::size_t>(next - candidates);
}

/// Compares one turn's candidates. \returns the end of the matches.
TemplateMatch* compare(const PoseTemplates& templates, const SampledReading& reading,
                       std::uint32_t turn, std::span<const std::uint32_t> candidates,
                       const TemplateLimits& limits, TemplateMatch* next) {
  const hn::CappedTag<std::int8_t, PoseTemplates::kSamples> d;
  const auto deeper = hn::Set(d, limits.tolerance);
  const auto nearer = hn::Neg(deeper);
  const auto first = static_cast<int>(PoseTemplates::kRings * turn);
  const std::uint64_t has_reading = std::rotr(reading.has_reading, first);
  for (const std::uint32_t index : candidates) {
    const std::int8_t* depths =
        templates.depths.data() + PoseTemplates::kSamples * std::size_t{index};
    std::uint64_t behind = 0;
    std::uint64_t in_front = 0;
    for (std::size_t i = 0; i < PoseTemplates::kSamples; i += hn::Lanes(d)) {
      const auto error =
          hn::SaturatedSub(hn::LoadU(d, reading.depths + first + i), hn::LoadU(d, depths + i));
      behind |= bits_of(d, hn::Gt(error, deeper)) << i;
      in_front |= bits_of(d, hn::Lt(error, nearer)) << i;
    }
    const std::uint64_t compared = templates.inside[index] & has_reading;
    const int support_n = std::popcount(compared & ~(behind | in_front));
    const int refute_n = std::popcount(compared & behind);
    const float score = static_cast<float>(support_n - refute_n) /
                        static_cast<float>(std::popcount(compared) + kFewSamples);
    // Written in any case, kept by moving on: which of them are kept can't be foreseen.
    *next = {score, index, turn};
    next += static_cast<int>(support_n >= limits.min_support_n) &
            static_cast<int>(score >= limits.min_score);
  }
  return next;
}

void match_templates(const PoseTemplates& templates, const SampledReading& reading,
                     const TemplateLimits& limits, TemplateMatches& matches) {
  const std::size_t most = templates.size() * PoseTemplates::kTurns;
  if (matches.kept.size() <= most) {
    matches.kept.resize(most + 1);
    matches.candidates.resize(templates.size() + PoseTemplates::kReadAhead);
  }
  matches.compared_n = 0;
  TemplateMatch* next = matches.kept.data();
  for (std::uint32_t turn = 0; turn < PoseTemplates::kTurns; ++turn) {
    const std::size_t count =
        find_candidates(templates, reading, turn, limits.min_cosine, matches.candidates.data());
    next = compare(templates, reading, turn, {matches.candidates.data(), count}, limits, next);
    matches.compared_n += count;
  }
  matches.kept_n = static_cast<std::size_t>(next - matches.kept.data());
}

}  // namespace graspd::perception::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace graspd::perception {
HWY_EXPORT(match_templates);
void match_templates(const parts::PoseTemplates& templates, const SampledReading& reading,
                     const TemplateLimits& limits, TemplateMatches& matches) {
  HWY_DYNAMIC_DISPATCH(match_templates)(templates, reading, limits, matches);
}
}  // namespace graspd::perception
#endif
