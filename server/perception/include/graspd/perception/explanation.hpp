#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "graspd/perception/is_late.hpp"
#include "graspd/perception/pose_hypothesis.hpp"
#include "graspd/perception/scene.hpp"

namespace graspd::perception {

/// A pose that was accepted.
struct ExplainedPart {
  PoseHypothesis pose;
  std::vector<std::uint32_t> cells;  ///< that it explains
};

/// What `explain` found.
struct Explanation {
  std::vector<ExplainedPart> parts;
  std::optional<Refusal> refusal;  ///< of the refused pose that came nearest
};

/// Drops rough poses whose readings several better ones explain: what is left is worth refining.
void keep_promising(const DepthGrid& grid, const PoseVerifier& verifier,
                    const RegistrationParameters& parameters, std::vector<PoseHypothesis>& poses);

/// The parts that together explain most of the image. Promising poses are refined, each as if it
/// were alone; of those that the image allows, the set is chosen that explains most; its members
/// are refined once more, each among the others: what one claims speaks for no other.
/// \param grid the image; accepted parts claim their cells in it. \param verifier of that grid.
/// \param poses roughly placed and scored. \param explanation these parts are added to; none is
/// where one of it is already.
void explain(DepthGrid& grid, const PoseVerifier& verifier, const Scene& scene,
             std::vector<PoseHypothesis> poses, const RegistrationParameters& parameters,
             const IsLate& is_late, Explanation& explanation);

/// What the bin says of each part of the explanation.
std::vector<BinTerms> terms_in_bin(const DepthGrid& grid, const PoseVerifier& verifier,
                                   const Explanation& explanation);

/// Sets each part's confidence to what it is in this bin, and drops what is too improbable there.
/// \param explanation of the whole image: nothing more is found in it.
void weigh_in_bin(const DepthGrid& grid, const PoseVerifier& verifier,
                  const RegistrationParameters& parameters, Explanation& explanation);

}  // namespace graspd::perception
