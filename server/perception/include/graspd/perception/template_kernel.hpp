#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "graspd/parts/pose_templates.hpp"

/// The inner loop of the search for hypotheses, in the widest vectors that the machine has.
namespace graspd::perception {

/// The depth image around a reading, sampled as a template is.
struct SampledReading {
  static constexpr int kSamples = parts::PoseTemplates::kSamples;
  /// As in a template, twice over, so that every turn is a run of kSamples.
  std::int8_t depths[2 * kSamples];
  std::uint64_t has_reading;  ///< bit i: sample i has one
  /// The reading's normal, as the templates' are given; in turn k it is k turns less.
  float normal_sine, normal_cosine, normal_turns;
};

/// What a match must be to be kept.
struct TemplateLimits {
  float min_cosine = -2;       ///< between the reading's normal and the anchor's
  std::int8_t tolerance = 10;  ///< of depths
  /// Samples within tolerance, and the score. No parameters of the pipeline: the best few of each
  /// seed are chosen from what passes, and these two only spare the sorting of what has no chance.
  /// Without them as many parts are found on tuning frames.
  int min_support_n = 8;
  float min_score = 0.5F;
  std::size_t most_n = 0;  ///< matches that are wanted
};

/// A template in one of its turns.
struct TemplateMatch {
  float score = 0;  ///< samples within tolerance less those behind, of those compared; above 0
  std::uint32_t place = 0;  ///< template and turn in one number, so that a match is 64 bits

  TemplateMatch() = default;
  TemplateMatch(float match_score, std::uint32_t index, std::uint32_t turn)
      : score(match_score), place(parts::PoseTemplates::kTurns * index + turn) {}
  std::uint32_t index() const { return place / parts::PoseTemplates::kTurns; }
  std::uint32_t turn() const { return place % parts::PoseTemplates::kTurns; }
  /// Larger is better; the first template and turn of equal ones. Floats above 0 are in the order
  /// of their bits.
  std::uint64_t rank() const {
    return std::uint64_t{std::bit_cast<std::uint32_t>(score)} << 32 | ~place;
  }
};

/// What `match_templates` finds; made once and used again, so that nothing is allocated.
struct TemplateMatches {
  std::size_t compared_n = 0;
  std::size_t kept_n = 0;
  std::vector<TemplateMatch> kept;                ///< the leading `kept_n`: the best, best first
  std::vector<std::int32_t> first_turn, turns_n;  ///< of each template; working memory

  /// Drops all but the best; they are not sorted.
  /// \returns the score of the worst that is left, or 0 where there were no more.
  float keep_best(std::size_t most_n);
  void sort_best_first();
};

/// Compares with every template in every turn in which its anchor's normal agrees.
void match_templates(const parts::PoseTemplates& templates, const SampledReading& reading,
                     const TemplateLimits& limits, TemplateMatches& matches);

}  // namespace graspd::perception
