#pragma once

#include <string>

#include "graspd/parts/part.hpp"

namespace graspd::parts {

/// "symmetries_discrete: 5 (60° about (0, 0, 1)); symmetries_continuous: 0", in BOP's terms.
std::string symmetries_sentence(const Symmetries& symmetries);

}  // namespace graspd::parts
