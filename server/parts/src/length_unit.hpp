#pragma once

#include <optional>
#include <string>

#include "graspd/parts/mesh.hpp"

namespace graspd::parts {

constexpr double metres_per(LengthUnit unit) {
  switch (unit) {
    case LengthUnit::kMetre:
      return 1.0;
    case LengthUnit::kMillimetre:
      return 1e-3;
    case LengthUnit::kInch:
      return 25.4e-3;
  }
  return 1.0;
}

/// Outside these no bin-picking cell can see or lift a part: the unit must be wrong.
inline constexpr double kMinDiameter_m = 0.002;
inline constexpr double kMaxDiameter_m = 2.0;

/// Which unit would make an implausible size plausible, as a clause to end a sentence with.
/// `declared` is what the part file said; without it, every mix-up that would explain the size.
std::string probable_unit(double diameter_m, std::optional<LengthUnit> declared);

}  // namespace graspd::parts
