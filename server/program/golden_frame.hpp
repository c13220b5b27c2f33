#pragma once

#include "graspd/parts/part.hpp"
#include "graspd/perception/parameters.hpp"
#include "graspd/service/worker.hpp"

namespace graspd::program {

/// A depth frame made at start, of one part that lies on its broad side on a floor, seen from
/// above: a worker must find it where it lies. It is small, scaled to the part, and within the
/// depths that `parameters` look at, so that it says something of this catalogue, this
/// configuration, this build and this machine.
service::GoldenFrame make_golden_frame(const parts::Part& part,
                                       const perception::Parameters& parameters);

}  // namespace graspd::program
