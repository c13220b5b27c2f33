#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>
#include <thread>

#include "graspd/client/client.hpp"
#include "graspd/parts/catalogue.hpp"
#include "graspd/perception/planner.hpp"
#include "same_message.hpp"
#include "serve_process.hpp"
#include "serve_scene.hpp"

// The real server, asked by the real client: what a cell sees of it.
namespace graspd::testing {
namespace {

using client::Client;
using std::chrono::milliseconds;
using std::chrono::seconds;
using ::testing::HasSubstr;

constexpr seconds kBudget{30};
const Eigen::Vector3d kBrick_m{0.06, 0.04, 0.03};

struct Cell {
  std::string name;
  DepthFrame frame;
  PlanRequest request;
};

Cell make_cell(const std::string& name, const CameraIntrinsics& camera,
               const std::vector<Block>& blocks, const std::string& part) {
  Cell cell;
  cell.name = name;
  cell.frame = render(camera, kHeight_m, blocks);
  cell.request.T_base_camera = T_base_camera_above(kHeight_m);
  cell.request.bin = Bin{Eigen::Isometry3d::Identity(), {0.4, 0.3, 0.1}, 0.003};
  cell.request.parts = {{part, 0}};
  return cell;
}

class ServeTest : public ::testing::Test {
 protected:
  ServeTest() {
    write_box_part(folder_, "bar", 1, kBar_m * 1000);
    write_box_part(folder_, "brick", 2, kBrick_m * 1000);
  }

  std::vector<std::string> arguments(const std::string& workers = "1") const {
    return {"--parts", (folder_.path() / "parts").string(), "--workers", workers};
  }
  Cell kinect_cell() const {
    return make_cell("kinect", kinect_v2(),
                     {bar_at(0.05, 0.03, 0.4, kBar_m), bar_at(-0.08, 0.02, -0.9, kBar_m)}, "bar");
  }
  Cell other_cell() const {
    return make_cell("other", {640, 480, 525, 525, 319.5, 239.5, {}},
                     {bar_at(0.0, -0.05, 1.2, kBrick_m)}, "brick");
  }

  TemporaryFolder folder_;
};

client::ClientOptions named(const std::string& cell) {
  client::ClientOptions options;
  options.cell = cell;
  return options;
}

void wait_for_health(Client& client, const std::function<bool(const HealthAnswer&)>& wanted) {
  while (true) {
    const auto health = client.health(kBudget).at(0).health;
    ASSERT_TRUE(health) << health.error().message;
    if (wanted(*health)) return;
  }
}

bool alive(pid_t pid) { return ::kill(pid, 0) == 0; }

TEST_F(ServeTest, TwoCellsWithDifferentCamerasAndPartsGetWhatTheLibraryPlans) {
  ServeProcess server(arguments("2"));
  ASSERT_TRUE(server.wait_ready());
  const auto catalogue = parts::Catalogue::load(folder_.path() / "parts");
  ASSERT_TRUE(catalogue) << catalogue.error().message;

  const auto serve_cell = [&](const Cell& cell) {
    auto expected = perception::plan(cell.frame, cell.request, *catalogue, {});
    ASSERT_TRUE(expected) << expected.error().message;
    expected->timings.clear();
    Client client({server.data_endpoint}, named(cell.name));
    for (int i = 0; i < 5; ++i) {
      auto answer = client.plan(cell.frame, cell.request, kBudget);
      ASSERT_TRUE(answer) << answer.error().message;
      ASSERT_FALSE(answer->timings.empty());
      EXPECT_EQ(answer->server.catalogue_hash, catalogue->hash());
      answer->timings.clear();
      answer->server = {};
      EXPECT_TRUE(Same<PlanAnswer>::check(*answer, *expected)) << cell.name;
    }
  };
  std::thread first([&] { serve_cell(kinect_cell()); });
  std::thread second([&] { serve_cell(other_cell()); });
  first.join();
  second.join();
}

TEST_F(ServeTest, AWorkerKilledWhileItComputesCostsItsRequestAlone) {
  ServeProcess server(arguments());
  ASSERT_TRUE(server.wait_ready());
  Client client({server.data_endpoint});
  const Cell cell = kinect_cell();
  const std::vector<pid_t> workers = server.workers();
  ASSERT_EQ(workers.size(), 1u);
  ::kill(workers[0], SIGSTOP);  // so that it holds the request for sure
  auto lost = client.submit(cell.frame, cell.request, kBudget);
  wait_for_health(client, [](const HealthAnswer& health) { return health.workers_busy_n == 1; });
  ::kill(workers[0], SIGKILL);
  const auto answer = lost.get();
  ASSERT_FALSE(answer);
  EXPECT_EQ(answer.error().code, Code::kInternal);
  EXPECT_THAT(answer.error().message, HasSubstr("signal 9"));
  EXPECT_TRUE(client.plan(cell.frame, cell.request, kBudget));
  EXPECT_NE(server.workers(), workers);
}

TEST_F(ServeTest, SigtermLosesNothingThatWasAccepted) {
  ServeProcess server(arguments());
  ASSERT_TRUE(server.wait_ready());
  Client client({server.data_endpoint});
  const Cell cell = kinect_cell();
  const pid_t worker = server.workers().at(0);
  ::kill(worker, SIGSTOP);
  auto running = client.submit(cell.frame, cell.request, kBudget);
  auto queued = client.submit(cell.frame, cell.request, kBudget);
  wait_for_health(client, [](const HealthAnswer& health) {
    return health.workers_busy_n == 1 && health.queued_n == 1;
  });
  server.kill(SIGTERM);
  wait_for_health(
      client, [](const HealthAnswer& health) { return health.state == ServerState::kDraining; });
  ::kill(worker, SIGCONT);
  EXPECT_TRUE(running.get());
  EXPECT_TRUE(queued.get());
  EXPECT_EQ(server.wait(), 0);
  EXPECT_FALSE(alive(worker));
}

TEST_F(ServeTest, WorkersDoNotOutliveAServerThatIsKilled) {
  ServeProcess server(arguments("2"));
  ASSERT_TRUE(server.wait_ready());
  const std::vector<pid_t> workers = server.workers();
  ASSERT_EQ(workers.size(), 2u);
  server.kill(SIGKILL);
  EXPECT_EQ(server.wait(), -SIGKILL);
  for (const pid_t worker : workers) {
    while (alive(worker)) std::this_thread::yield();
  }
}

TEST_F(ServeTest, OneServersDeathFailsNoRequestWhileAnotherLives) {
  ServeProcess first(arguments());
  ServeProcess second(arguments());
  ASSERT_TRUE(first.wait_ready());
  ASSERT_TRUE(second.wait_ready());
  const Cell cell = other_cell();
  std::atomic<int> answered = 0;
  std::vector<std::thread> cells;
  for (int i = 0; i < 3; ++i) {
    cells.emplace_back([&, i] {
      Client client({first.data_endpoint, second.data_endpoint}, named(std::to_string(i)));
      for (int request = 0; request < 10; ++request) {
        const auto answer = client.plan(cell.frame, cell.request, kBudget);
        EXPECT_TRUE(answer) << answer.error().message;
        ++answered;
      }
    });
  }
  while (answered < 10) std::this_thread::yield();
  first.kill(SIGKILL);
  for (std::thread& thread : cells) thread.join();
  EXPECT_EQ(answered, 30);
}

TEST_F(ServeTest, PlansInItsOwnProcessWithoutWorkers) {
  ServeProcess server(arguments("0"));
  ASSERT_TRUE(server.wait_ready());
  EXPECT_TRUE(server.workers().empty());
  Client client({server.data_endpoint});
  const Cell cell = kinect_cell();
  const auto answer = client.plan(cell.frame, cell.request, kBudget);
  EXPECT_TRUE(answer) << answer.error().message;
  server.kill(SIGTERM);
  EXPECT_EQ(server.wait(), 0);
}

TEST_F(ServeTest, UnknownPartsAndBadRequestsAreRefusedByTheServer) {
  ServeProcess server(arguments());
  ASSERT_TRUE(server.wait_ready());
  Client client({server.data_endpoint});
  Cell cell = kinect_cell();
  cell.request.parts = {{"gizmo", 0}};
  const auto unknown = client.plan(cell.frame, cell.request, kBudget);
  ASSERT_FALSE(unknown);
  EXPECT_EQ(unknown.error().code, Code::kUnknownPart);
  EXPECT_THAT(unknown.error().message, HasSubstr("bar, brick"));
}

/// What `grasp_server serve` says where it can't start.
class ServeRefusals : public ServeTest {
 protected:
  Finished serve(const std::string& arguments) const {
    return run(std::string(GRASP_SERVER) + " serve " + arguments);
  }
  Finished serve_file(const std::string& yaml) const {
    return serve("--config " + folder_.write("server.yaml", yaml).string());
  }
};

TEST_F(ServeRefusals, NameTheKeyTheFileAndTheLine) {
  Finished refused = serve_file("parts: parts\nworker: 3\n");
  EXPECT_EQ(refused.exit_code, 2);
  EXPECT_THAT(refused.output, HasSubstr("server.yaml:2: unknown key 'worker'"));

  refused = serve_file("parts: parts\nworkers_n: [1, 2]\n");
  EXPECT_EQ(refused.exit_code, 2);
  EXPECT_THAT(refused.output, HasSubstr("server.yaml:2: 'workers_n' must be a whole number"));
}

TEST_F(ServeRefusals, NameThePartsFolderThatIsNotThere) {
  const Finished refused = serve_file("insecure: true\nparts: nowhere\n");
  EXPECT_EQ(refused.exit_code, 2);
  EXPECT_THAT(refused.output, HasSubstr("nowhere"));
}

TEST_F(ServeRefusals, NameTheEndpointThatOthersReach) {
  const Finished refused =
      serve_file("insecure: true\nparts: parts\ndata_endpoint: tcp://0.0.0.0:0\n");
  EXPECT_EQ(refused.exit_code, 2);
  EXPECT_THAT(refused.output, HasSubstr("insecure: true"));
}

TEST_F(ServeRefusals, NameThePortInUse) {
  ServeProcess server(arguments());
  ASSERT_TRUE(server.wait_ready());
  const Finished refused =
      serve_file("insecure: true\nparts: parts\ndata_endpoint: " + server.data_endpoint + "\n");
  EXPECT_EQ(refused.exit_code, 3);
  EXPECT_THAT(refused.output, HasSubstr(server.data_endpoint + " is in use"));
}

TEST_F(ServeRefusals, WrongCommandLines) {
  EXPECT_EQ(serve("--no-such-option").exit_code, 2);
  EXPECT_EQ(serve("--log-level loud").exit_code, 2);
  EXPECT_EQ(run(GRASP_SERVER).exit_code, 2);
  EXPECT_EQ(run(std::string(GRASP_SERVER) + " --help").exit_code, 0);
  EXPECT_THAT(run(std::string(GRASP_SERVER) + " --version").output,
              ::testing::MatchesRegex("grasp_server [0-9]+\\.[0-9]+\\.[0-9]+.*\n"));
}

}  // namespace
}  // namespace graspd::testing
