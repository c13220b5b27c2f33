#include "why_none.hpp"

#include <fmt/format.h>

namespace graspd::perception {

std::string why_none(std::size_t segments_n, const RegistrationResult& registered,
                     const RegistrationParameters& parameters) {
  std::string tried = fmt::format("{} segments, but none of {} poses tried stands", segments_n,
                                  registered.hypotheses_n);
  if (const auto& refusal = registered.refusal) {
    return fmt::format("{}: the best, of part '{}', has {:.3g} where {} is {:.3g}", tried,
                       refusal->part->id, refusal->value, refusal->parameter, refusal->limit);
  }
  if (parameters.method != Registration::kVerified) return tried;  // none could be laid in them
  return fmt::format("{}: none fits well enough for a closer look (min_coarse_score is {:.3g})",
                     tried, parameters.min_coarse_score);
}

}  // namespace graspd::perception
