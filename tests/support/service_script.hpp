#pragma once

#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include "graspd/service/worker.hpp"

/// A planner that does what the requested part's name says, for tests and for the worker program
/// that they start.
namespace graspd::service {

inline const std::vector<std::string> kScriptedParts{
    "crash", "echo",     "empty",     "hang", "hungry",  "large", "larger",     "largest",
    "other", "sleep_20", "sleep_100", "spin", "spin_20", "throw", "throw_bytes"};
inline const ServerInfo kScriptedServer{"scripted", "catalogue", "config"};

/// About `bytes` of outline on the wire, for what clients ask for on top.
inline std::vector<float> long_outline(std::size_t bytes) {
  return std::vector<float>(bytes / sizeof(float), 123.5F);
}

inline std::vector<Grasp> long_rejected_grasps() {
  Grasp grasp;
  grasp.pick_point = std::string(100, 'x');
  return std::vector<Grasp>(4000, grasp);
}

inline Result<PlanAnswer> scripted_plan(const DepthFrame& frame, const PlanRequest& request,
                                        std::chrono::steady_clock::time_point deadline) {
  const std::string& script = request.parts.at(0).id;
  const auto start = std::chrono::steady_clock::now();
  PlanAnswer answer;
  if (script == "empty") return answer;
  if (script == "crash") std::raise(SIGKILL);
  while (script == "hang") pause();
  while (script == "spin" && std::chrono::steady_clock::now() < deadline) {
  }
  // A worker that has a core to itself, and one that needs one.
  if (script == "sleep_20") std::this_thread::sleep_for(std::chrono::milliseconds(20));
  if (script == "sleep_100") std::this_thread::sleep_for(std::chrono::milliseconds(100));
  while (script == "spin_20" &&
         std::chrono::steady_clock::now() - start < std::chrono::milliseconds(20)) {
  }
  if (script == "hungry") answer.reason = std::to_string(std::vector<char>(1U << 30).size());
  if (script == "throw") throw std::runtime_error("the script says so");
  if (script == "throw_bytes") throw std::runtime_error(std::string(300'000, '\xff'));
  // What the request was, so that an answer to another one shows.
  answer.funnel.pixels_n =
      static_cast<std::uint32_t>(frame.camera.width_px * frame.camera.height_px);
  answer.funnel.readings_n = static_cast<std::uint32_t>(
      std::count_if(frame.depth.begin(), frame.depth.end(), [](auto z) { return z != 0; }));
  for (const RequestedPart& part : request.parts) {
    Object object;
    object.id = static_cast<std::uint32_t>(answer.objects.size());
    object.part_id = part.id;
    answer.objects.push_back(object);
  }
  answer.timings.push_back({"script", 1});
  if (script == "large") answer.rejected_grasps = long_rejected_grasps();
  if (script == "larger") answer.objects[0].outline_px = long_outline(300'000);
  if (script == "largest") answer.reason = std::string(300'000, 'x');
  return answer;
}

}  // namespace graspd::service
