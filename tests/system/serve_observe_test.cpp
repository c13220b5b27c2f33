#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <sstream>

#include "graspd/client/client.hpp"
#include "http_get.hpp"
#include "metrics_text.hpp"
#include "serve_process.hpp"
#include "serve_scene.hpp"

// What the real server tells of itself: HTTP, its log, what it records.
namespace graspd::testing {
namespace {

using client::Client;
using std::chrono::seconds;
using ::testing::HasSubstr;

class ObserveTest : public ::testing::Test {
 protected:
  ObserveTest() {
    write_box_part(folder_, "bar", 1, kBar_m * 1000);
    frame_ = render(kinect_v2(), kHeight_m, {bar_at(0.05, 0.03, 0.4, kBar_m)});
    request_.T_base_camera = T_base_camera_above(kHeight_m);
    request_.bin = Bin{Eigen::Isometry3d::Identity(), {0.4, 0.3, 0.1}, 0.003};
    request_.parts = {{"bar", 0}};
  }
  std::vector<std::string> arguments() const {
    return {"--parts",         (folder_.path() / "parts").string(),
            "--workers",       "1",
            "--http-endpoint", "tcp://127.0.0.1:0"};
  }
  std::string path(const std::string& name) const { return (folder_.path() / name).string(); }
  std::string config(const std::string& yaml) const {
    return folder_.write("server.yaml", "parts: parts\n" + yaml).string();
  }

  TemporaryFolder folder_;
  DepthFrame frame_;
  PlanRequest request_;
};

TEST_F(ObserveTest, HttpTellsOfPlansAndOfDraining) {
  ServeProcess server(arguments());
  ASSERT_TRUE(server.wait_ready());
  EXPECT_EQ(http_get(server.http_url, "/livez").status, 200);
  HttpAnswer ready;
  while (ready.status != 200) ready = http_get(server.http_url, "/readyz");
  Client client({server.data_endpoint});
  ASSERT_TRUE(client.plan(frame_, request_, seconds(30)));
  (void)client.health();  // counted when the next question is answered
  const MetricsText metrics = parse_metrics(http_get(server.http_url, "/metrics").body);
  EXPECT_EQ(metrics.at("graspd_answers_total{cell=\"other\",code=\"OK\"}"), 1);
  EXPECT_EQ(metrics.at("graspd_planned_parts_total{part=\"bar\"}"), 1);
  for (const std::string stage :
       {"queue", "decode", "preprocess", "segmentation", "registration"}) {
    EXPECT_EQ(metrics.at("graspd_stage_seconds_count{stage=\"" + stage + "\"}"), 1) << stage;
  }
  const pid_t worker = server.workers().at(0);
  ::kill(worker, SIGSTOP);  // so that something is left to finish
  auto running = client.submit(frame_, request_, seconds(30));
  while (client.health().at(0).health->workers_busy_n == 0) {
  }
  server.kill(SIGTERM);
  while (ready.status != 503) ready = http_get(server.http_url, "/readyz");
  EXPECT_THAT(ready.body, HasSubstr("shutting down"));
  ::kill(worker, SIGCONT);
  EXPECT_TRUE(running.get());
  EXPECT_EQ(server.wait(), 0);
}

TEST_F(ObserveTest, APartThatIsNotFoundInItsGoldenFrameKeepsTheServerFromGettingReady) {
  // More than any part covers.
  const std::string file = config("perception:\n  registration:\n    min_explained_px: 100000\n");
  const Finished refused = run("timeout 30 " + std::string(GRASP_SERVER) +
                               " serve --insecure --endpoint tcp://127.0.0.1:0 --control-endpoint "
                               "tcp://127.0.0.1:0 --workers 1 --config " +
                               file);
  EXPECT_EQ(refused.exit_code, 1);
  EXPECT_THAT(refused.output, HasSubstr("the golden frame: part 'bar', alone on a floor, was not "
                                        "found"));
  EXPECT_THAT(refused.output, HasSubstr("check its mesh"));
}

TEST_F(ObserveTest, EveryLineOfTheLogIsJsonAndAFailedRequestCanBeSentAgain) {
  const std::string log = path("log");
  const std::string file =
      config("flight_recorder:\n  folder: flights\nworker_time_limit_ms: 300\n");
  ServeProcess server({"--config", file, "--workers", "1"}, log);
  ASSERT_TRUE(server.wait_ready());
  client::ClientOptions options;
  options.dispatch.max_attempts_n = 1;
  Client client({server.data_endpoint}, options);
  ::kill(server.workers().at(0), SIGSTOP);  // it computes for too long
  const RequestId id{0xee, 7};
  EXPECT_FALSE(client.plan(frame_, request_, seconds(30), id));

  // The record is written after the answer has gone out.
  const std::filesystem::path flights = path("flights/default");
  const auto is_record = [](const auto& entry) { return entry.path().extension() == ".flight"; };
  std::error_code not_yet;
  while (std::ranges::none_of(std::filesystem::directory_iterator(flights, not_yet), is_record)) {
  }
  const Finished replayed = run(std::string(GRASP) + " replay " + flights.string() +
                                "/*_ee070000*.flight --server " + server.data_endpoint);
  EXPECT_EQ(replayed.exit_code, 0) << replayed.output;
  EXPECT_THAT(replayed.output, HasSubstr("PLANNED"));
  EXPECT_THAT(replayed.output, HasSubstr("; was INTERNAL ("));
  server.kill(SIGTERM);
  EXPECT_EQ(server.wait(), 0);

  std::ifstream lines(log);
  std::string line;
  int requests_n = 0;
  while (std::getline(lines, line)) {
    const auto json = nlohmann::json::parse(line);
    EXPECT_TRUE(json.contains("time") && json.contains("level")) << line;
    requests_n += json.contains("request_id") ? 1 : 0;
  }
  EXPECT_EQ(requests_n, 2);
}

TEST_F(ObserveTest, HttpBeyondThisMachineMustBeSaid) {
  const std::string serve = std::string(GRASP_SERVER) + " serve --insecure --config ";
  const Finished refused = run(serve + config("http:\n  endpoint: tcp://0.0.0.0:0\n"));
  EXPECT_EQ(refused.exit_code, 2);
  EXPECT_THAT(refused.output, HasSubstr("expose: true"));
  const Finished no_endpoint = run(serve + config("http:\n  endpoint: localhost\n"));
  EXPECT_EQ(no_endpoint.exit_code, 2);
  EXPECT_THAT(no_endpoint.output, HasSubstr("http: endpoint: 'localhost' is no endpoint"));
}

}  // namespace
}  // namespace graspd::testing
