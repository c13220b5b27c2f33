#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <thread>

#include "graspd/client/client.hpp"
#include "serve_process.hpp"
#include "serve_scene.hpp"

// Keys as a person handles them: grasp keys, grasp_server, grasp plan and health, SIGHUP.
namespace graspd::testing {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

constexpr std::chrono::seconds kBudget{30};
const Eigen::Vector3d kBar_mm{80, 24, 20};

class KeysSystemTest : public ::testing::Test {
 protected:
  KeysSystemTest() {
    write_box_part(folder_, "bar", 1, kBar_mm);
    grasp("keys new server --out " + path(""));
    make_and_allow("tees");
  }

  std::string path(const std::string& name) const { return (folder_.path() / name).string(); }
  static Finished grasp(const std::string& arguments) {
    return run(std::string(GRASP) + " " + arguments);
  }
  void make(const std::string& cell) const {
    const Finished made = grasp("keys new " + cell + " --out " + path(""));
    ASSERT_EQ(made.exit_code, 0) << made.output;
  }
  void make_and_allow(const std::string& cell) const {
    make(cell);
    const Finished allowed = grasp("keys allow " + path(cell + ".pub") + list_option());
    ASSERT_EQ(allowed.exit_code, 0) << allowed.output;
  }
  std::string list_option() const { return " --list " + path("allowed_cells"); }

  std::vector<std::string> server_arguments() const {
    return {"--parts", path("parts"),      "--workers",       "1",
            "--key",   path("server.key"), "--allowed-cells", path("allowed_cells")};
  }
  Finished serve_refused(const std::string& more) const {
    return run(fmt::format("{} serve --parts {} {}", GRASP_SERVER, path("parts"), more));
  }
  Finished health(const ServeProcess& server, const std::string& cell) const {
    return grasp(fmt::format("health --server {} --server-key {} --key {}", server.control_endpoint,
                             path("server.pub"), path(cell + ".key")));
  }
  client::ClientOptions options_of(const std::string& cell) const {
    client::ClientOptions options;
    options.cell = cell;
    options.keys = keys::read_client_keys(path("server.pub"), path(cell + ".key")).value();
    return options;
  }
  static Result<PlanAnswer> plan(client::Client& client, const std::string& part) {
    PlanRequest request;
    request.T_base_camera = T_base_camera_above(kHeight_m);
    request.bin = Bin{Eigen::Isometry3d::Identity(), {0.4, 0.3, 0.1}, 0.003};
    request.parts = {{part, 0}};
    return client.plan(render(kinect_v2(), kHeight_m, {}), request, kBudget);
  }

  TemporaryFolder folder_;
};

TEST_F(KeysSystemTest, ACellWithAnAllowedKeyIsServedAndNobodyElse) {
  ServeProcess server(server_arguments());
  ASSERT_TRUE(server.wait_ready());
  const Finished known = health(server, "tees");
  EXPECT_EQ(known.exit_code, 0) << known.output;
  EXPECT_THAT(known.output, HasSubstr("ready"));
  const Finished stats =
      grasp(fmt::format("stats --once --server {} --server-key {} --key {}",
                        server.control_endpoint, path("server.pub"), path("tees.key")));
  EXPECT_EQ(stats.exit_code, 0) << stats.output;

  make("stranger");
  const Finished unknown = health(server, "stranger");
  EXPECT_EQ(unknown.exit_code, 2);
  EXPECT_THAT(unknown.output, HasSubstr("UNAUTHENTICATED: " + server.control_endpoint +
                                        " does not allow this client's key"));
  const Finished plain = grasp("health --server " + server.data_endpoint);
  EXPECT_EQ(plain.exit_code, 2) << plain.output;
  EXPECT_THAT(plain.output, HasSubstr("server_key"));
}

TEST_F(KeysSystemTest, PlanAsksInTheNameOfTheKeysCell) {
  write_camera(folder_, "camera.yaml", kinect_v2(), kHeight_m);
  write_frame(folder_, "floor.png", render(kinect_v2(), kHeight_m, {}));
  ServeProcess server(server_arguments());
  ASSERT_TRUE(server.wait_ready());
  const std::string question =
      fmt::format("plan --server {} --server-key {} --key {} --depth {} --camera {} --part bar ",
                  server.data_endpoint, path("server.pub"), path("tees.key"), path("floor.png"),
                  path("camera.yaml"));
  const Finished planned = grasp(question);
  EXPECT_EQ(planned.exit_code, 4) << planned.output;  // nothing to grasp
  const Finished other = grasp(question + "--cell-name elbows");
  EXPECT_EQ(other.exit_code, 2);
  EXPECT_THAT(other.output, HasSubstr("UNAUTHENTICATED: cell: the request says 'elbows'"));
}

TEST_F(KeysSystemTest, SighupRevokesAndAllowsWhileItServes) {
  make("elbows");
  ServeProcess server(server_arguments());
  ASSERT_TRUE(server.wait_ready());
  client::Client tees({server.data_endpoint}, options_of("tees"));
  client::Client elbows({server.data_endpoint}, options_of("elbows"));
  ASSERT_TRUE(plan(tees, "bar"));
  EXPECT_EQ(plan(elbows, "bar").error().code, Code::kUnauthenticated);
  const std::vector<pid_t> workers = server.workers();

  ASSERT_EQ(grasp("keys revoke tees" + list_option()).exit_code, 0);
  ASSERT_EQ(grasp("keys allow " + path("elbows.pub") + list_option()).exit_code, 0);
  server.kill(SIGHUP);
  while (plan(tees, "bar")) {
  }
  EXPECT_EQ(plan(tees, "bar").error().code, Code::kUnauthenticated);
  while (!plan(elbows, "bar")) {
  }
  EXPECT_EQ(server.workers(), workers) << "the parts have not changed";
}

/// Whether the process has this signal wait, instead of being ended by it.
bool blocks(pid_t pid, int signal) {
  std::ifstream status(fmt::format("/proc/{}/status", pid));
  for (std::string word; status >> word;) {
    if (word != "SigBlk:") continue;
    std::uint64_t mask = 0;
    status >> std::hex >> mask;
    return (mask >> (signal - 1) & 1) != 0;
  }
  return false;
}

TEST_F(KeysSystemTest, SighupAtAnyMomentOfTheStartIsObeyed) {
  write_box_part(folder_, "brick", 2, {60, 40, 30});
  make("elbows");
  // From the first moment to when it is about to be ready.
  for (const int delay_ms : {0, 40, 150}) {
    SCOPED_TRACE(fmt::format("SIGHUP {} ms after the signal is held", delay_ms));
    std::filesystem::rename(path("parts/brick"), path("brick"));
    ServeProcess server(server_arguments(), path("log"));
    while (!blocks(server.pid(), SIGHUP)) std::this_thread::yield();
    std::this_thread::sleep_for(std::chrono::milliseconds(delay_ms));
    std::filesystem::rename(path("brick"), path("parts/brick"));
    ASSERT_EQ(grasp("keys allow " + path("elbows.pub") + list_option()).exit_code, 0);
    server.kill(SIGHUP);
    ASSERT_TRUE(server.wait_ready()) << run("cat " + path("log")).output;
    client::Client client({server.data_endpoint}, options_of("elbows"));
    const auto end = std::chrono::steady_clock::now() + kBudget;
    bool is_known = false;
    while (!is_known && std::chrono::steady_clock::now() < end) {
      is_known = plan(client, "brick").has_value();
    }
    EXPECT_TRUE(is_known) << run("cat " + path("log")).output;
    server.kill(SIGTERM);
    EXPECT_EQ(server.wait(), 0);
    ASSERT_EQ(grasp("keys revoke elbows" + list_option()).exit_code, 0);
  }
}

TEST_F(KeysSystemTest, SighupTakesUpNewPartsAndKeepsTheOldOnesWhereTheNewAreWrong) {
  ServeProcess server(server_arguments());
  ASSERT_TRUE(server.wait_ready());
  client::Client client({server.data_endpoint}, options_of("tees"));
  EXPECT_EQ(plan(client, "brick").error().code, Code::kUnknownPart);
  write_box_part(folder_, "brick", 2, {60, 40, 30});
  server.kill(SIGHUP);
  while (true) {
    const auto answer = plan(client, "brick");
    if (answer) break;
    ASSERT_EQ(answer.error().code, Code::kUnknownPart) << answer.error().message;
  }
  const std::string hash = plan(client, "brick")->server.catalogue_hash;

  folder_.write("parts/broken/part.yaml", "id: broken\n");
  server.kill(SIGHUP);
  // Its allow-list is read at the same moment: once that is in force, the signal has arrived.
  make_and_allow("late");
  server.kill(SIGHUP);
  client::Client late({server.data_endpoint}, options_of("late"));
  while (!plan(late, "bar")) {
  }
  EXPECT_EQ(plan(client, "brick")->server.catalogue_hash, hash);
  server.kill(SIGTERM);
  EXPECT_EQ(server.wait(), 0);
}

TEST_F(KeysSystemTest, AServerWithoutKeysDoesNotStartUnlessThatIsSaid) {
  const Finished refused = serve_refused("");
  EXPECT_EQ(refused.exit_code, 2);
  EXPECT_THAT(refused.output, AllOf(HasSubstr("grasp keys new server"), HasSubstr("--insecure")));
  const Finished open = serve_refused("--insecure --endpoint tcp://0.0.0.0:0");
  EXPECT_EQ(open.exit_code, 2);
  EXPECT_THAT(open.output, HasSubstr("can be reached from other machines"));
}

TEST_F(KeysSystemTest, AServerWhoseKeyOthersMayReadDoesNotStart) {
  const std::string keys =
      fmt::format("--key {} --allowed-cells {}", path("server.key"), path("allowed_cells"));
  std::filesystem::permissions(path("server.key"), std::filesystem::perms(0644));
  const Finished readable = serve_refused(keys);
  EXPECT_EQ(readable.exit_code, 2);
  EXPECT_THAT(readable.output, AllOf(HasSubstr("server.key"), HasSubstr("chmod 600")));
  std::filesystem::remove(path("server.key"));
  const Finished missing = serve_refused(keys);
  EXPECT_EQ(missing.exit_code, 2);
  EXPECT_THAT(missing.output, HasSubstr("No such file"));
}

TEST_F(KeysSystemTest, ASecondServerOnAnIpcEndpointDoesNotStart) {
  const std::string endpoints =
      fmt::format("--endpoint ipc://{} --control-endpoint ipc://{}", path("data"), path("control"));
  ServeProcess server({"--parts", path("parts"), "--workers", "1", "--endpoint",
                       "ipc://" + path("data"), "--control-endpoint", "ipc://" + path("control")});
  ASSERT_TRUE(server.wait_ready());
  const Finished second = serve_refused("--insecure " + endpoints);
  EXPECT_EQ(second.exit_code, 3);
  EXPECT_THAT(second.output, HasSubstr("is in use: another server runs there"));
  EXPECT_EQ(grasp("health --server ipc://" + path("control")).exit_code, 0);
}

TEST_F(KeysSystemTest, CommandsSayWhatTheyDidAndWhatIsWrong) {
  const Finished again = grasp("keys new tees --out " + path(""));
  EXPECT_EQ(again.exit_code, 2);
  EXPECT_THAT(again.output, HasSubstr("never overwritten"));
  const Finished made = grasp("keys new elbows --out " + path("keys"));
  EXPECT_EQ(made.exit_code, 0);
  EXPECT_THAT(made.output, AllOf(HasSubstr("elbows.key  secret"), HasSubstr("elbows.pub  public")));
  const Finished secret = grasp("keys allow " + path("keys/elbows.key") + list_option());
  EXPECT_EQ(secret.exit_code, 2);
  EXPECT_THAT(secret.output, HasSubstr("is a secret key"));
  ASSERT_EQ(grasp("keys allow " + path("keys/elbows.pub") + list_option()).exit_code, 0);
  const Finished listed = grasp("keys list" + list_option());
  EXPECT_EQ(listed.exit_code, 0);
  EXPECT_THAT(listed.output, AllOf(HasSubstr("tees"), HasSubstr("elbows")));
  const Finished revoked = grasp("keys revoke elbows" + list_option());
  EXPECT_EQ(revoked.exit_code, 0);
  EXPECT_THAT(revoked.output, HasSubstr("not allowed any more (1 key); a running server takes it "
                                        "up on SIGHUP"));
  EXPECT_THAT(grasp("keys list" + list_option()).output, Not(HasSubstr("elbows")));
  EXPECT_EQ(grasp("keys revoke elbows" + list_option()).exit_code, 2);
  EXPECT_EQ(grasp("keys").exit_code, 2);
  EXPECT_EQ(grasp("health --key " + path("tees.key")).exit_code, 2);
}

}  // namespace
}  // namespace graspd::testing
