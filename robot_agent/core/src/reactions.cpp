#include "graspd/agent/reactions.hpp"

#include <stdexcept>

namespace graspd::agent {

Reaction Reactions::to(Outcome outcome) const {
  switch (outcome) {
    case Outcome::kBinEmpty:
      return bin_empty;
    case Outcome::kBinNotFound:
      return bin_not_found;
    case Outcome::kNoneRegistered:
      return none_registered;
    case Outcome::kAllInCollision:
      return all_in_collision;
    case Outcome::kNoneReachable:
      return none_reachable;
    case Outcome::kPlanned:
    case Outcome::kUnchanged:
      break;
  }
  throw std::logic_error("reactions: a plan with grasps needs none");
}

bool Reactions::any(Reaction reaction) const {
  return bin_empty == reaction || bin_not_found == reaction || none_registered == reaction ||
         all_in_collision == reaction || none_reachable == reaction;
}

}  // namespace graspd::agent
