#include "length_unit.hpp"

#include <vector>

namespace graspd::parts {
namespace {

// Most parts that a bin-picking cell handles are of this size.
constexpr double kUsualMin_m = 0.015;
constexpr double kUsualMax_m = 0.6;

}  // namespace

std::string probable_unit(double diameter_m, std::optional<LengthUnit> declared) {
  std::vector<std::string> mix_ups;
  for (const auto& [said, said_name] : EnumNames<LengthUnit>::values) {
    if (declared && said != *declared) continue;
    for (const auto& [meant, meant_name] : EnumNames<LengthUnit>::values) {
      const double would_be_m = diameter_m / metres_per(said) * metres_per(meant);
      if (meant == said || would_be_m < kUsualMin_m || would_be_m > kUsualMax_m) continue;
      mix_ups.push_back(
          declared ? fmt::format("{} (then it is {:.4g} mm across)", meant_name, would_be_m * 1e3)
                   : fmt::format("{} instead of {} (then it is {:.4g} mm across)", meant_name,
                                 said_name, would_be_m * 1e3));
    }
  }
  if (mix_ups.empty()) return "no other unit makes its size likely: check the scale of the export";
  return fmt::format("its unit is probably {}", fmt::join(mix_ups, ", or "));
}

}  // namespace graspd::parts
