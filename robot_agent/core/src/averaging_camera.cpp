#include "graspd/agent/averaging_camera.hpp"

#include "graspd/types/mean_frame.hpp"

namespace graspd::agent {

AveragingCamera::AveragingCamera(std::shared_ptr<Camera> camera, std::size_t frames_n)
    : camera_(std::move(camera)), frames_n_(frames_n) {}

Result<std::optional<DepthFrame>> AveragingCamera::next() {
  frames_.clear();
  while (frames_.size() < frames_n_) {
    auto frame = camera_->next();
    if (!frame) return frame;
    if (!*frame) break;
    frames_.push_back(*std::move(*frame));
  }
  if (frames_.empty()) return std::nullopt;
  auto mean = mean_frame(frames_);
  if (!mean) return tl::unexpected(mean.error());
  return *std::move(mean);
}

}  // namespace graspd::agent
