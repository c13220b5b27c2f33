#pragma once

#include "graspd/parts/catalogue.hpp"
#include "graspd/perception/is_late.hpp"
#include "graspd/perception/parameters.hpp"
#include "graspd/types/answer.hpp"
#include "graspd/types/request.hpp"

namespace graspd::perception {

/// The whole of perception and grasp planning: one depth frame in, ranked grasps out.
///
/// A pure function of its arguments: no sockets, files, clocks that change an answer, or state kept
/// between calls. Any number of threads may call it at once. The answer's bytes do not depend on
/// how many threads of the caller's TBB arena work on it; only `timings` differ between calls.
///
/// \returns INVALID_ARGUMENT for a frame or request that fails validation, UNKNOWN_PART for a part
/// that the catalogue does not have, DEADLINE_EXCEEDED where `is_late` says so between two steps.
/// "Nothing found" is an answer, not an error.
Result<PlanAnswer> plan(const DepthFrame& frame, const PlanRequest& request,
                        const parts::Catalogue& catalogue, const Parameters& parameters,
                        const IsLate& is_late = never_late);

}  // namespace graspd::perception
