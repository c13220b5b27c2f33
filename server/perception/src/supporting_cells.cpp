#include "supporting_cells.hpp"

#include <tbb/enumerable_thread_specific.h>

#include "parallel.hpp"

namespace graspd::perception {

SupportingCells::SupportingCells(const DepthGrid& grid, const PoseVerifier& verifier,
                                 std::span<const PoseHypothesis> poses, double tolerance_m)
    : count_(poses.size()) {
  std::size_t most_n = 0;
  for (const PoseHypothesis& pose : poses) {
    first_.push_back(most_n);
    most_n += verifier.view(pose).points_n;
  }
  cells_.resize(most_n);
  tbb::enumerable_thread_specific<CellMarks> marks(grid.size());
  parallel_for(poses.size(), [&](std::size_t i) {
    count_[i] =
        verifier.supporting_cells(poses[i], tolerance_m, marks.local(), cells_.data() + first_[i]);
  });
}

}  // namespace graspd::perception
