#include "cell_request.hpp"

namespace graspd::robot_agent {

Result<PlanRequest> make_request(const CellConfig& config, const CellFrames& frames) {
  PlanRequest request;
  request.T_base_camera = frames.T_base_camera;
  request.bin = frames.bin;
  request.parts = config.parts;
  request.gripper = config.gripper;
  request.options = config.options;
  if (const auto ok = validate(request); !ok) return tl::unexpected(ok.error());
  return request;
}

}  // namespace graspd::robot_agent
