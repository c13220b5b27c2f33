#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

#include "graspd/types/request.hpp"

namespace graspd::program {

/// What to look for, and where: the same options for every command that asks with a frame.
struct RequestArguments {
  std::string camera;
  std::string cell;
  std::vector<std::string> parts;
};

/// \returns the options without which there is no request.
std::vector<CLI::Option*> add_request_options(CLI::App& command, RequestArguments& arguments);

struct CellRequest {
  CameraIntrinsics camera;
  double depth_scale_m = 0;
  PlanRequest request;
};
Result<CellRequest> read_cell_request(const RequestArguments& arguments);

}  // namespace graspd::program
