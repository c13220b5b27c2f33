#pragma once

#include <string>

namespace graspd::service {

/// "0.1.0+3f2a1bc": the version, and the commit it was built from; "-dirty" where files differed.
std::string build_id();

}  // namespace graspd::service
