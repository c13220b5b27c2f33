#include <iostream>

#include "graspd/client/client.hpp"
#include "graspd/formats/cell.hpp"
#include "graspd/formats/depth_image.hpp"

// The client library in five lines: client_example tcp://127.0.0.1:5555 camera.yaml depth.png tee
int main(int count, char** words) {
  if (count != 5) return 2;
  const auto camera = graspd::read_camera(words[2]);
  const auto image = graspd::read_png16(words[3]);
  if (!camera || !image) return 2;
  const graspd::DepthFrame frame{camera->camera, camera->depth_scale_m, image->values};
  graspd::PlanRequest request;
  request.T_base_camera = camera->T_base_camera.value_or(graspd::looking_down());
  request.parts = {{words[4], 0}};

  graspd::client::Client client({words[1]});
  const auto answer = client.plan(frame, request, std::chrono::seconds(10));
  if (!answer) return std::cerr << answer.error().message << "\n", 1;
  std::cout << name_of(answer->outcome) << "\n";
  for (const auto& grasp : answer->grasps) std::cout << grasp.T_base_grasp.matrix() << "\n\n";
}
