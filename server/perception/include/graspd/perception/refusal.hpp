#pragma once

#include <string_view>

#include "graspd/parts/part.hpp"

namespace graspd::perception {

/// Why a pose is no answer: the parameter that decided, and how far the pose is from it.
struct Refusal {
  const parts::Part* part = nullptr;
  std::string_view parameter;  ///< its name in `RegistrationParameters`
  double limit = 0;
  double value = 0;
};

}  // namespace graspd::perception
