#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdint>
#include <cstdlib>
#include <fstream>
#include <nlohmann/json.hpp>
#include <set>

#include "graspd/client/client.hpp"
#include "serve_process.hpp"
#include "serve_scene.hpp"

// The real server on a machine that has no disk left, or whose clock is set while it serves.
namespace graspd::testing {
namespace {

using client::Client;
using std::chrono::seconds;
using ::testing::HasSubstr;

constexpr seconds kBudget{30};

class ServiceHost : public ::testing::Test {
 protected:
  ServiceHost() {
    write_box_part(folder_, "bar", 1, kBar_m * 1000);
    frame_ = render(kinect_v2(), kHeight_m, {bar_at(0.05, 0.03, 0.4, kBar_m)});
    request_.T_base_camera = T_base_camera_above(kHeight_m);
    request_.bin = Bin{Eigen::Isometry3d::Identity(), {0.4, 0.3, 0.1}, 0.003};
    request_.parts = {{"bar", 0}};
  }
  std::string path(const std::string& name) const { return (folder_.path() / name).string(); }
  void expect_plans(const ServeProcess& server, int plans_n) const {
    Client client({server.data_endpoint});
    for (int i = 0; i < plans_n; ++i) {
      const auto answer = client.plan(frame_, request_, kBudget);
      ASSERT_TRUE(answer) << answer.error().message;
      EXPECT_EQ(answer->outcome, Outcome::kPlanned);
    }
  }

  TemporaryFolder folder_;
  DepthFrame frame_;
  PlanRequest request_;
};

TEST_F(ServiceHost, AFullDiskUnderTheLogCostsTheLogAlone) {
  // Every write to it fails with ENOSPC.
  ServeProcess server({"--parts", path("parts"), "--workers", "1"}, "/dev/full");
  ASSERT_TRUE(server.wait_ready());
  expect_plans(server, 5);
  server.kill(SIGTERM);
  EXPECT_EQ(server.wait(), 0);
}

TEST_F(ServiceHost, NoRoomForAFailedRequestIsALineOfTheLog) {
  // /dev/full is no folder, so that nothing can be kept there, whoever runs this.
  const std::string config = folder_
                                 .write("server.yaml",
                                        "parts: parts\nflight_recorder:\n  folder: /dev/full\n"
                                        "worker_time_limit_ms: 300\n")
                                 .string();
  const std::string log = path("log");
  ServeProcess server({"--config", config, "--workers", "1"}, log);
  ASSERT_TRUE(server.wait_ready());
  ::kill(server.workers().at(0), SIGSTOP);  // it computes for too long
  Client client({server.data_endpoint});
  EXPECT_EQ(client.plan(frame_, request_, kBudget).error().code, Code::kInternal);
  expect_plans(server, 1);
  server.kill(SIGTERM);
  EXPECT_EQ(server.wait(), 0);
  std::ifstream lines(log);
  const std::string text{std::istreambuf_iterator<char>(lines), {}};
  EXPECT_THAT(text, HasSubstr("could not be kept"));
}

TEST_F(ServiceHost, AClockThatJumpsChangesNoAnswerAndNoDeadline) {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
  GTEST_SKIP() << "a sanitizer must be the first library that is loaded";
#endif
  const auto set_clock = [&](std::int64_t offset_s) {
    std::fstream file(path("offset"), std::ios::in | std::ios::out | std::ios::binary);
    file.write(reinterpret_cast<const char*>(&offset_s), sizeof offset_s);
  };
  folder_.write("offset", std::string(8, '\0'));
  setenv("LD_PRELOAD", JUMPING_CLOCK, 1);
  setenv("GRASPD_CLOCK_OFFSET", path("offset").c_str(), 1);
  const std::string log = path("log");
  ServeProcess server({"--parts", path("parts"), "--workers", "1"}, log);
  unsetenv("LD_PRELOAD");
  ASSERT_TRUE(server.wait_ready());
  for (const std::int64_t hours : {0, 24, -24, 0}) {
    set_clock(hours * 3600);
    expect_plans(server, 2);
  }
  server.kill(SIGTERM);
  EXPECT_EQ(server.wait(), 0);
  // That it did jump is seen in the log; that nobody noticed, in the times it took.
  std::ifstream lines(log);
  std::set<std::string> days;
  for (std::string line; std::getline(lines, line);) {
    const auto json = nlohmann::json::parse(line);
    if (!json.contains("total_ms")) continue;
    days.insert(json.at("time").get<std::string>().substr(0, 10));
    EXPECT_GE(json.at("total_ms"), 0);
    EXPECT_LT(json.at("total_ms"), 30'000);
  }
  EXPECT_EQ(days.size(), 3u);
}

}  // namespace
}  // namespace graspd::testing
