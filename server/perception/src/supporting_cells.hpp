#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "graspd/perception/pose_hypothesis.hpp"

namespace graspd::perception {

/// Of each of some poses the cells whose open readings lie within `tolerance_m` of it, each once.
class SupportingCells {
 public:
  SupportingCells(const DepthGrid& grid, const PoseVerifier& verifier,
                  std::span<const PoseHypothesis> poses, double tolerance_m);

  std::span<const std::uint32_t> of(std::size_t pose) const {
    return {cells_.data() + first_[pose], count_[pose]};
  }

 private:
  std::vector<std::size_t> first_, count_;
  std::vector<std::uint32_t> cells_;
};

}  // namespace graspd::perception
