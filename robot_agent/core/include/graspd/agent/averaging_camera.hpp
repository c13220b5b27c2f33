#pragma once

#include <memory>

#include "graspd/agent/ports.hpp"

namespace graspd::agent {

/// A camera that looks several times before it answers: each frame is the mean (mean_frame.hpp) of
/// the next few of another camera, while the cell stands still. For live cameras: a recording's
/// frames may be of different piles.
class AveragingCamera final : public Camera {
 public:
  /// \param frames_n of which a mean is made, 1 to kMaxMeanFrames.
  AveragingCamera(std::shared_ptr<Camera> camera, std::size_t frames_n);

  /// The mean of the next frames, stamped as the first of them; of fewer where there will be no
  /// more. \returns the first error of the other camera, or that its frames are not alike.
  Result<std::optional<DepthFrame>> next() override;

 private:
  std::shared_ptr<Camera> camera_;
  std::size_t frames_n_;
  std::vector<DepthFrame> frames_;
};

}  // namespace graspd::agent
