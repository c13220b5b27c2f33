#include "graspd/perception/confidence.hpp"

#include <algorithm>
#include <cmath>

namespace graspd::perception {
namespace {

struct LogOdds {
  float at_zero, fit, refuted, log_support, leftover;
};
constexpr LogOdds kAlone{-17.023F, 5.184F, -118.25F, 2.686F, -8.437F};

struct LogOddsInBin {
  float at_zero, alone, explained, leftover;
};
constexpr LogOddsInBin kInBin{-2.149F, 0.904F, 2.34F, -30.736F};

float probability(float log_odds) { return 1 / (1 + std::exp(-log_odds)); }

}  // namespace

float confidence_alone(const ConfidenceTerms& terms) {
  return probability(kAlone.at_zero + kAlone.fit * terms.fit + kAlone.refuted * terms.refuted +
                     kAlone.log_support * terms.log_support + kAlone.leftover * terms.leftover);
}

float confidence_in_bin(const BinTerms& terms) {
  const float alone = std::log(terms.alone / (1 - terms.alone));
  const float explained = std::min(1.0F, terms.explained / kExplainedEnough);
  return probability(kInBin.at_zero + kInBin.alone * alone + kInBin.explained * explained +
                     kInBin.leftover * (1 - explained) * terms.leftover);
}

}  // namespace graspd::perception
