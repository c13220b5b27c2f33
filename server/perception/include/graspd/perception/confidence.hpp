#pragma once

/// How probable it is that a pose is right (MSSD below a tenth of the part's diameter), by logistic
/// regression in two steps. `./run bench confidence` fits the constants.
namespace graspd::perception {

/// What the image says of a pose that was refined.
struct ConfidenceTerms {
  float fit = 0;          ///< of the view's points: supported, each by its weight, less refuted
  float refuted = 0;      ///< share of the points that were tested
  float log_support = 0;  ///< natural logarithm of how many readings support it
  float leftover = 0;     ///< share of the outline beyond which the surface goes on
};
/// In a bin that holds the parts that are asked for and nothing else.
float confidence_alone(const ConfidenceTerms& terms);

/// What the bin says of a part that was found in it.
struct BinTerms {
  float alone = 0;      ///< its confidence alone, within (0, 1)
  float explained = 0;  ///< of the bin's readings: by found parts, each by its confidence alone
  float leftover = 0;   ///< as above, where the surface that goes on is no found part's
};
/// Where the found parts explain so much of a bin, it holds what was asked for: simulated bins of
/// nothing else were explained by 0.22 and more, half of those with ten parts among 35 others by
/// less than 0.18. Real frames ask for so low a bound: at 0.35 a bin of elbows lost five of seven.
inline constexpr float kExplainedEnough = 0.2F;

/// In this bin. Where less is explained, there are things that nobody asked for, and pieces of
/// these look like parts: their surface goes on beyond the outline.
float confidence_in_bin(const BinTerms& terms);

}  // namespace graspd::perception
