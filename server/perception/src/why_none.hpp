#pragma once

#include <string>

#include "graspd/perception/registration.hpp"

namespace graspd::perception {

/// The sentence of an answer without parts: what the pose lacked that the frame supports best.
std::string why_none(std::size_t segments_n, const RegistrationResult& registered,
                     const RegistrationParameters& parameters);

}  // namespace graspd::perception
