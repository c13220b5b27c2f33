#include "fake_ros_arm.hpp"

#include <arpa/inet.h>
#include <ros/callback_queue.h>
#include <ros/ros.h>
#include <sensor_msgs/JointState.h>
#include <signal.h>
#include <spawn.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <trajectory_msgs/JointTrajectory.h>
#include <unistd.h>

#include <filesystem>
#include <stdexcept>
#include <thread>

namespace graspd::testing {
namespace {

using Clock = std::chrono::steady_clock;

std::uint16_t free_port() {
  const int listener = socket(AF_INET, SOCK_STREAM, 0);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  auto* any = reinterpret_cast<sockaddr*>(&address);
  socklen_t size = sizeof(address);
  const bool bound = bind(listener, any, size) == 0 && getsockname(listener, any, &size) == 0;
  close(listener);
  if (!bound) throw std::runtime_error("no port on loopback");
  return ntohs(address.sin_port);
}

class Master {
 public:
  Master() {
    const std::string port = std::to_string(free_port());
    setenv("ROS_MASTER_URI", ("http://127.0.0.1:" + port).c_str(), 1);
    setenv("ROS_IP", "127.0.0.1", 1);
    setenv("ROS_LOG_DIR", (std::filesystem::temp_directory_path() / "graspd-ros-log").c_str(), 1);
    std::string words[] = {"rosmaster", "--core", "-p", port};
    char* arguments[] = {words[0].data(), words[1].data(), words[2].data(), words[3].data(),
                         nullptr};
    if (posix_spawnp(&process_, "rosmaster", nullptr, nullptr, arguments, environ) != 0) {
      throw std::runtime_error("no rosmaster: install python3-rosmaster");
    }
    ros::init(ros::M_string{}, "graspd_test", ros::init_options::NoSigintHandler);
    const auto until = Clock::now() + std::chrono::seconds(30);
    while (!ros::master::check()) {
      if (Clock::now() > until) throw std::runtime_error("rosmaster does not answer");
      std::this_thread::yield();
    }
  }
  ~Master() {
    ros::shutdown();
    kill(process_, SIGTERM);
    waitpid(process_, nullptr, 0);
  }

 private:
  pid_t process_ = 0;
};

}  // namespace

void need_ros_master() { static const Master master; }

struct FakeRosArm::Ros {
  ros::CallbackQueue queue;
  ros::NodeHandle node;
  ros::Publisher states;
  ros::Subscriber commands;
  trajectory_msgs::JointTrajectory path;
  double moved_s = 0;
  std::thread thread;
};

std::vector<std::string> FakeRosArm::joint_names() {
  return {"joint_1", "joint_2", "joint_3", "joint_4", "joint_5", "joint_6"};
}

FakeRosArm::FakeRosArm(std::vector<double> q_rad)
    : ros_(std::make_unique<Ros>()), q_rad_(std::move(q_rad)) {
  ros_->node.setCallbackQueue(&ros_->queue);
  ros_->states = ros_->node.advertise<sensor_msgs::JointState>("joint_states", 1);
  const boost::function<void(const trajectory_msgs::JointTrajectory&)> take =
      [this](const trajectory_msgs::JointTrajectory& path) {
        if (path.points.empty()) {
          ++stops_n_;
          if (!ignores_stops_) moves_ = false;
          return;
        }
        ros_->path = path;
        ros_->moved_s = 0;
        moves_ = true;
      };
  ros_->commands =
      ros_->node.subscribe<trajectory_msgs::JointTrajectory>("joint_path_command", 1, take);
  ros_->thread = std::thread([this] { run(); });
}

FakeRosArm::~FakeRosArm() {
  over_ = true;
  ros_->thread.join();
}

void FakeRosArm::run() {
  auto last = Clock::now();
  while (!over_) {
    ros_->queue.callAvailable(ros::WallDuration(0.01));
    const auto now = Clock::now();
    if (moves_) advance(std::chrono::duration<double>(now - last).count());
    last = now;
    if (silent_in_motion_ && moves_) continue;
    sensor_msgs::JointState state;
    // Other joints may come first: a gripper's, say.
    state.name = {"finger"};
    state.position = {0.01};
    const auto names = joint_names();
    state.name.insert(state.name.end(), names.begin(), names.end());
    state.position.insert(state.position.end(), q_rad_.begin(), q_rad_.end());
    ros_->states.publish(state);
  }
}

void FakeRosArm::advance(double seconds) {
  ros_->moved_s += seconds;
  const auto& points = ros_->path.points;
  if (halts_in_motion_ && ros_->moved_s > points.back().time_from_start.toSec() / 5) {
    moves_ = false;
    return;
  }
  q_rad_ = points.back().positions;
  for (std::size_t i = 1; i < points.size(); ++i) {
    const double from_s = points[i - 1].time_from_start.toSec();
    const double to_s = points[i].time_from_start.toSec();
    if (ros_->moved_s >= to_s) continue;
    for (std::size_t joint = 0; joint < q_rad_.size(); ++joint) {
      const double from_rad = points[i - 1].positions[joint];
      const double share = (ros_->moved_s - from_s) / (to_s - from_s);
      q_rad_[joint] = from_rad + share * (points[i].positions[joint] - from_rad);
    }
    return;
  }
  if (!ignores_stops_) moves_ = false;
}

}  // namespace graspd::testing
