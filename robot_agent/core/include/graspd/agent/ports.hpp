#pragma once

#include <chrono>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "graspd/agent/motions.hpp"
#include "graspd/types/answer.hpp"
#include "graspd/types/frame.hpp"
#include "graspd/types/request.hpp"

/// All that the pick cycle knows of the world. Each adapter stands for one outside thing: a camera
/// or a recording, an arm, a gripper, the perception server, the clock, the cell's operator. The
/// cycle calls them from one thread; every call blocks until it is done or has failed.
///
/// An Error says that the thing itself failed: the cycle then stops. "The gripper is empty" and
/// "out of reach" are not errors but answers.
namespace graspd::agent {

/// Where depth frames come from.
class Camera {
 public:
  virtual ~Camera() = default;
  /// The newest frame of a camera, the next one of a recording; nothing when there will be no more.
  /// A camera that may give a frame from before the call stamps it: what is from before the arm's
  /// last motion is not planned on.
  virtual Result<std::optional<DepthFrame>> next() = 0;
};

/// What the arm must keep clear of until it is told anew.
struct Surroundings {
  std::optional<Bin> bin;
  std::vector<Eigen::Vector3f> p_base_m;  ///< readings of the frame that the grasps were planned on
};

/// Brings the gripper to poses in base. A gripper may be brought there turned by 180° about its
/// approach, where its jaws are alike.
class Arm {
 public:
  virtual ~Arm() = default;
  /// In the place of those before. The arm stands where it stood when they were seen.
  virtual void set_surroundings(const Surroundings& surroundings) = 0;
  /// Why the arm can't do these motions one after the other, with the step of the first that it
  /// can't; nothing where it can. Nothing moves.
  virtual std::optional<std::string> why_not(std::span<const Motion> motions) = 0;
  /// Returns when the arm stands at the pose. \returns INVALID_ARGUMENT as `why_not` says it where
  /// the arm can't: it has not moved then.
  virtual Result<void> move(const Motion& motion) = 0;
  /// To where the camera sees nothing of the arm.
  virtual Result<void> move_out_of_view() = 0;
  /// Stand still, now, and hold: what is done after any error. The gripper stays as it is.
  /// \returns why it is not known to stand: it may be moving.
  virtual Result<void> stop() = 0;
};

/// Parallel jaws, or a cup.
class Gripper {
 public:
  virtual ~Gripper() = default;
  /// Returns when the jaws are so far apart, between their inner faces.
  virtual Result<void> open(double opening_width_m) = 0;
  /// Until something is held, or nothing is left to close.
  virtual Result<void> close() = 0;
  /// Whether there is something between the closed fingers; never with fingers that were opened.
  virtual Result<bool> holds_something() = 0;
};

/// What came back for one frame; the id is known also where there was no answer.
struct PlanReply {
  std::string request_id;  ///< hexadecimal, as in the server's log
  Result<PlanAnswer> answer;
};

/// Turns a frame into a plan: a perception server, or a test's script.
class Planner {
 public:
  virtual ~Planner() = default;
  /// Waits for the answer, as long as the planner's budget is.
  virtual PlanReply plan(const DepthFrame& frame, const PlanRequest& request) = 0;
};

/// What an operator may answer.
enum class OperatorSays { kGoOn, kStop };

/// Whoever looks after the cell.
class Operator {
 public:
  virtual ~Operator() = default;
  /// Waits until the operator has answered. \param what a sentence: what is the matter.
  virtual OperatorSays ask(const std::string& what) = 0;
};

/// Monotonic time.
class Clock {
 public:
  virtual ~Clock() = default;
  /// Since some instant of its own; the same that frames are stamped by.
  virtual std::chrono::nanoseconds now() = 0;
  virtual void sleep_for(std::chrono::nanoseconds duration) = 0;
};

}  // namespace graspd::agent
