#pragma once

#include <chrono>
#include <optional>

#include "graspd/judge/grasp_judge.hpp"

namespace graspd::judge {

/// How finely is searched, and for how long.
struct SearchOptions {
  double spacing_m = 0.004;  ///< between the places on a part's surface that one jaw may touch
  int approaches_n = 24;     ///< around the closing direction
  double standoff_m = 0.08;
  std::chrono::milliseconds give_up_after{20'000};
};

/// What `find_good_grasp` found.
struct SearchResult {
  std::optional<TrueGrasp> grasp;  ///< the first good one
  bool is_complete = true;         ///< false: given up, so that nothing found says little
};

/// Looks for a grasp that the judge calls good: antipodal pairs of every part's true surface,
/// turned around the closing direction, at several depths and openings; the highest part and the
/// steepest approach first.
SearchResult find_good_grasp(const GraspJudge& judge, const SearchOptions& options = {});

}  // namespace graspd::judge
