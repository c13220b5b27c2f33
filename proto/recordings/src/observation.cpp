#include "observation.hpp"

#include <algorithm>
#include <cstdlib>

namespace graspd {
namespace {

// MRPT keeps the scale as a float: the shortest decimal that reads as this float is the number that
// was meant (0.001, not 0.00100000005).
double widen(float value) { return std::strtod(fmt::format("{}", value).c_str(), nullptr); }

}  // namespace

mrpt::obs::CObservation3DRangeScan to_observation(const DepthFrame& frame) {
  const CameraIntrinsics& camera = frame.camera;
  mrpt::obs::CObservation3DRangeScan observation;
  observation.sensorLabel = "depth";
  observation.hasRangeImage = true;
  observation.range_is_depth = true;
  observation.rangeUnits = static_cast<float>(frame.depth_scale_m);
  observation.rangeImage_setSize(camera.height_px, camera.width_px);
  std::copy(frame.depth.begin(), frame.depth.end(), observation.rangeImage.data());

  mrpt::img::TCamera& model = observation.cameraParams;
  model.ncols = static_cast<std::uint32_t>(camera.width_px);
  model.nrows = static_cast<std::uint32_t>(camera.height_px);
  model.setIntrinsicParamsFromValues(camera.fx_px, camera.fy_px, camera.cx_px, camera.cy_px);
  const bool distorted = std::any_of(camera.distortion.begin(), camera.distortion.end(),
                                     [](double coefficient) { return coefficient != 0; });
  model.distortion =
      distorted ? mrpt::img::DistortionModel::plumb_bob : mrpt::img::DistortionModel::none;
  std::copy(camera.distortion.begin(), camera.distortion.end(), model.dist.begin());
  return observation;
}

Result<DepthFrame> to_frame(const mrpt::obs::CObservation3DRangeScan& observation) {
  if (!observation.hasRangeImage) return invalid("the observation has no depth image");
  if (observation.rangeImage_isExternallyStored()) {
    return invalid(
        "the depth image is stored outside the rawlog: record it with the images inside");
  }
  if (!observation.range_is_depth) {
    return invalid("the image holds ranges along the rays, not depths: convert it first");
  }
  const mrpt::img::TCamera& model = observation.cameraParams;
  if (model.distortion == mrpt::img::DistortionModel::kannala_brandt) {
    return invalid("the camera has a fisheye model (kannala_brandt): rectify the images first");
  }

  DepthFrame frame;
  frame.camera.width_px = static_cast<int>(observation.rangeImage.cols());
  frame.camera.height_px = static_cast<int>(observation.rangeImage.rows());
  frame.camera.fx_px = model.fx();
  frame.camera.fy_px = model.fy();
  frame.camera.cx_px = model.cx();
  frame.camera.cy_px = model.cy();
  if (model.distortion == mrpt::img::DistortionModel::plumb_bob) {
    std::copy_n(model.dist.begin(), frame.camera.distortion.size(),
                frame.camera.distortion.begin());
  }
  frame.depth_scale_m = widen(observation.rangeUnits);
  const auto* data = observation.rangeImage.data();
  frame.depth.assign(data, data + observation.rangeImage.size());
  return frame;
}

}  // namespace graspd
