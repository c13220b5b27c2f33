#pragma once

#include <chrono>
#include <cstdint>
#include <memory>
#include <string>

#include "graspd/agent/joint_driver.hpp"
#include "graspd/agent/motion_watch.hpp"

/// An arm whose controller speaks ROS-Industrial's *simple message* over TCP, as the PROBOT Anno's
/// does; no ROS is needed. Whole trajectories are downloaded to its MOTION port, its STATE port
/// says where the joints are.
///
/// A motion is over when the controller says that the arm stands at the goal. Whatever else is
/// heard, or nothing at all for the watchdog's time, ends it with a stop (sequence −4, a service
/// request) and an error that says why; it also says so where the stop was not confirmed. After a
/// lost or garbled connection every call fails: connect anew. After an emergency stop or an error
/// of the controller the driver goes on when the controller does.
namespace graspd::simple_message {

/// Where the controller listens, and what the arm can do.
struct DriverOptions {
  std::string host = "127.0.0.1";
  std::uint16_t motion_port = 11000;
  std::uint16_t state_port = 11002;
  int joints_n = 6;
  double full_speed_rad_s = 3.0;             ///< of every joint at velocity 1
  std::chrono::milliseconds watchdog{1000};  ///< without joint positions or without status
  std::chrono::milliseconds reply_timeout{1000};
  agent::WatchLimits limits;
};

/// \returns UNAVAILABLE where a port can't be reached or no state comes within the watchdog's time,
/// INVALID_ARGUMENT for more joints than the protocol's 10.
Result<std::unique_ptr<agent::JointDriver>> connect(const DriverOptions& options);

}  // namespace graspd::simple_message
