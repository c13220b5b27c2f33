#pragma once

#include <string_view>
#include <utility>

#include "graspd/types/answer.hpp"

namespace graspd::agent {

/// What the cell does where there is nothing to pick.
enum class Reaction {
  kStop,
  kWait,  ///< pause, then look again; counts as a failure, unless the bin is empty
  kStir,  ///< a stroke through the top of the pile, then look again
  kAsk,   ///< the operator says whether to go on
};

/// One reaction for each outcome without a grasp.
struct Reactions {
  Reaction bin_empty = Reaction::kStop;
  Reaction bin_not_found = Reaction::kWait;
  Reaction none_registered = Reaction::kWait;
  Reaction all_in_collision = Reaction::kWait;
  Reaction none_reachable = Reaction::kWait;

  /// \param outcome one without a grasp: PLANNED and UNCHANGED have none: it throws
  /// std::logic_error.
  Reaction to(Outcome outcome) const;
  /// Whether any of them is this one.
  bool any(Reaction reaction) const;
};

}  // namespace graspd::agent

template <>
struct graspd::EnumNames<graspd::agent::Reaction> {
  using Reaction = agent::Reaction;
  static constexpr std::string_view what = "reaction";
  static constexpr std::pair<Reaction, std::string_view> values[] = {{Reaction::kStop, "stop"},
                                                                     {Reaction::kWait, "wait"},
                                                                     {Reaction::kStir, "stir"},
                                                                     {Reaction::kAsk, "ask"}};
};
