#pragma once

#include <string>

#include "graspd/agent/pick_record.hpp"

namespace graspd::record {

/// One pick as one line of JSON. What a pick did not come to is left out.
std::string to_json(const agent::PickRecord& record);

}  // namespace graspd::record
