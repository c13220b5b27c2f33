#pragma once

#include <string>

#include "graspd/onboarding/onboarding.hpp"

namespace graspd::onboarding {

/// One HTML page with all its pictures inside: it asks nothing of any other host, reads well on a
/// phone, in the dark and printed.
std::string html_report(const Onboarding& onboarding);

}  // namespace graspd::onboarding
