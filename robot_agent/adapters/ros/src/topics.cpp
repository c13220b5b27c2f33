#include "topics.hpp"

#include <ros/callback_queue.h>
#include <ros/ros.h>
#include <sensor_msgs/JointState.h>
#include <trajectory_msgs/JointTrajectory.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace graspd::ros_arm {

bool find_master() {
  if (!ros::isInitialized()) {
    ros::init(ros::M_string{}, "graspd_robot_agent", ros::init_options::NoSigintHandler);
  }
  return ros::master::check();
}

std::string master_uri() { return ros::master::getURI(); }

struct Topics::Ros {
  ros::CallbackQueue queue;  ///< served by `poll` alone: no thread of ROS's calls us
  ros::NodeHandle node;
  ros::Publisher command;
  ros::Subscriber states;
};

Topics::Topics(std::vector<std::string> joint_names, const std::string& command_topic,
               const std::string& state_topic)
    : joint_names_(std::move(joint_names)), ros_(std::make_unique<Ros>()) {
  ros_->node.setCallbackQueue(&ros_->queue);
  ros_->command = ros_->node.advertise<trajectory_msgs::JointTrajectory>(command_topic, 1);
  const boost::function<void(const sensor_msgs::JointState&)> take =
      [this](const sensor_msgs::JointState& state) {
        std::vector<double> q_rad;
        for (const std::string& name : joint_names_) {
          const auto found = std::find(state.name.begin(), state.name.end(), name);
          const auto at = static_cast<std::size_t>(found - state.name.begin());
          if (at >= state.position.size()) return;  // another node's joints
          if (!std::isfinite(state.position[at])) return;
          q_rad.push_back(state.position[at]);
        }
        q_rad_ = std::move(q_rad);
        ++states_n_;
      };
  ros_->states = ros_->node.subscribe<sensor_msgs::JointState>(state_topic, 1, take);
}

Topics::~Topics() = default;

std::string Topics::command_topic() const { return ros_->command.getTopic(); }
std::string Topics::state_topic() const { return ros_->states.getTopic(); }
bool Topics::has_listener() const { return ros_->command.getNumSubscribers() > 0; }

void Topics::command(const std::vector<TimedPoint>& points) {
  trajectory_msgs::JointTrajectory message;
  message.joint_names = joint_names_;
  for (const TimedPoint& point : points) {
    message.points.emplace_back();
    message.points.back().positions = point.q_rad;
    message.points.back().time_from_start = ros::Duration(point.t_s);
  }
  ros_->command.publish(message);
}

void Topics::poll(std::chrono::milliseconds timeout) {
  ros_->queue.callAvailable(ros::WallDuration(std::chrono::duration<double>(timeout).count()));
}

}  // namespace graspd::ros_arm
