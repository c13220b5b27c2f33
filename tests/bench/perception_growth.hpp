#pragma once

#include <string>
#include <vector>

#include "graspd/parts/catalogue.hpp"

/// How the time of a plan grows with the number of parts in the bin.
namespace graspd::bench {

struct GrowthOptions {
  int frames_n = 5;        ///< of each number of parts
  std::uint64_t seed = 1;  ///< of the first frame
  std::string part_id = "tee";
};

/// One frame, planned on one core.
struct GrowthRun {
  int asked_n = 0;  ///< parts dropped into the bin
  int parts_n = 0;  ///< of these, those that stayed in it
  int visible_n = 0;
  int answers_n = 0;
  int points_n = 0;
  double time_ms = 0;  ///< of the processor, frame to ranked grasps
};

/// Piles of 5 to 100 of one part in a bin that has room for all of them.
/// \returns the first failure to make a frame or to plan it.
Result<std::vector<GrowthRun>> measure_growth(const parts::Catalogue& catalogue,
                                              const GrowthOptions& options);

/// Medians for one number of parts; `asked_n` is the same in all.
GrowthRun median_of(const std::vector<GrowthRun>& runs, int asked_n);

/// The numbers of parts, ascending.
std::vector<int> asked_numbers(const std::vector<GrowthRun>& runs);

/// The exponent e of time ~ parts^e, by least squares over the logarithms of the medians: 1 is
/// linear.
double growth_exponent(const std::vector<GrowthRun>& runs);

}  // namespace graspd::bench
