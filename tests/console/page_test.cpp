#include <gmock/gmock.h>
#include <sys/wait.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <csignal>
#include <functional>
#include <thread>

#include "../system/serve_process.hpp"
#include "graspd/client/client.hpp"
#include "graspd/codec/codec.hpp"
#include "graspd/record/run_recorder.hpp"
#include "graspd/recorded/questions.hpp"
#include "temporary_folder.hpp"

// The console's page in a browser, fed by a real server's flight recorder: piles of tees as the
// simulated Kinect v2 sees them, planned by the real pipeline.
namespace graspd::testing {
namespace {

namespace fs = std::filesystem;
using namespace std::chrono_literals;
using std::chrono::milliseconds;

const std::string kSource = GRASPD_SOURCE_DIR;
const std::string kNodeModules = NODE_MODULES;

/// A child whose output is read line by line.
class Child {
 public:
  explicit Child(const std::vector<std::string>& words) {
    int output[2];
    if (pipe2(output, O_CLOEXEC) != 0) throw std::runtime_error("pipe failed");
    pid_ = fork();
    if (pid_ == 0) {
      dup2(output[1], STDOUT_FILENO);
      dup2(output[1], STDERR_FILENO);
      std::vector<char*> arguments;
      for (const std::string& word : words) arguments.push_back(const_cast<char*>(word.c_str()));
      arguments.push_back(nullptr);
      execvp(arguments[0], arguments.data());
      _exit(127);
    }
    close(output[1]);
    output_ = fdopen(output[0], "r");
  }
  ~Child() {
    end(SIGKILL);
    fclose(output_);
  }
  Child(const Child&) = delete;
  Child& operator=(const Child&) = delete;

  /// Empty at its end.
  std::string line() {
    char* text = nullptr;
    std::size_t size = 0;
    const ssize_t n = getline(&text, &size, output_);
    const std::string line(text, n > 0 ? static_cast<std::size_t>(n) : 0);
    free(text);
    return line;
  }
  int end(int signal = 0) {
    if (pid_ < 0) return status_;
    if (signal != 0) kill(pid_, signal);
    waitpid(std::exchange(pid_, -1), &status_, 0);
    return status_;
  }
  pid_t pid() const { return pid_; }

 private:
  pid_t pid_ = -1;
  int status_ = 0;
  FILE* output_ = nullptr;
};

/// `grasp console` on these flights.
class ConsoleProcess {
 public:
  ConsoleProcess(const fs::path& flights, const std::string& server, int port = 0,
                 const fs::path& records = {})
      : child_(words(flights, server, port, records)) {
    const std::string line = child_.line();
    const std::size_t at = line.find("http://");
    if (at == std::string::npos) throw std::runtime_error("no console: " + line);
    url = line.substr(at, line.size() - at - 1);
  }
  int port() const { return std::stoi(url.substr(url.rfind(':') + 1)); }
  void end() { child_.end(SIGTERM); }
  double resident_mib() const {
    std::ifstream statm(fmt::format("/proc/{}/statm", child_.pid()));
    double size = 0;
    double resident = 0;
    statm >> size >> resident;
    return resident * static_cast<double>(sysconf(_SC_PAGESIZE)) / (1 << 20);
  }

  std::string url;

 private:
  static std::vector<std::string> words(const fs::path& flights, const std::string& server,
                                        int port, const fs::path& records) {
    std::vector<std::string> all{GRASP,       "console",
                                 "--flights", flights.string(),
                                 "--parts",   kSource + "/deploy/parts",
                                 "--server",  server,
                                 "--listen",  fmt::format("127.0.0.1:{}", port)};
    if (!records.empty()) all.insert(all.end(), {"--records", records.string()});
    return all;
  }

  Child child_;
};

/// Does something again and again beside the test.
class Meanwhile {
 public:
  Meanwhile(milliseconds pace, std::function<void()> what)
      : thread_([this, pace, what = std::move(what)] {
          for (auto next = std::chrono::steady_clock::now(); !stop_; next += pace) {
            what();
            std::this_thread::sleep_until(next);
          }
        }) {}
  ~Meanwhile() {
    stop_ = true;
    thread_.join();
  }
  Meanwhile(const Meanwhile&) = delete;
  Meanwhile& operator=(const Meanwhile&) = delete;

 private:
  std::atomic<bool> stop_ = false;
  std::thread thread_;
};

class ConsolePageTest : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    if (!why_not().empty()) return;
    shared_ = std::make_unique<Shared>();
    const fs::path& folder = shared_->folder.path();
    const auto simulated = run(fmt::format(
        "{} --log-level warning simulate --parts {}/deploy/parts --part tee=8 --frames 3 --seed 1 "
        "--out {}/piles",
        ROBOT_AGENT, GRASPD_SOURCE_DIR, folder.string()));
    ASSERT_EQ(simulated.exit_code, 0) << simulated.output;
    const auto config = shared_->folder.write(
        "server.yaml",
        fmt::format("parts: {}/deploy/parts\nflight_recorder:\n  folder: {}\n  keep: "
                    "all\n",
                    GRASPD_SOURCE_DIR, flights().string()));
    shared_->server = std::make_unique<ServeProcess>(
        std::vector<std::string>{"--config", config.string(), "--workers", "1"});
    ASSERT_TRUE(shared_->server->wait_ready());
    for (int n = 0; n < 3; ++n) {
      const auto planned = run(fmt::format(
          "{0} plan --depth {1}/piles/depth/{3:06}.png --part tee --camera {1}/piles/camera.yaml "
          "--cell "
          "{1}/piles/cell.yaml --cell-name tees --explain --overlay {1}/plan.png --server {2}",
          GRASP, folder.string(), shared_->server->data_endpoint, n));
      ASSERT_EQ(planned.exit_code, 0) << planned.output;
    }
    auto questions = recorded::open_questions(flights()).value();
    while (auto question = questions->next().value()) {
      shared_->recorded.push_back(std::move(question->asked));
    }
    ASSERT_EQ(shared_->recorded.size(), 3u);
  }
  static void TearDownTestSuite() { shared_.reset(); }
  void SetUp() override {
    if (const std::string why = why_not(); !why.empty()) GTEST_SKIP() << why;
  }

  static std::string why_not() {
    if (!fs::exists("/usr/bin/chromium") || !fs::exists(kNodeModules + "/playwright-core") ||
        !fs::exists(fs::path(GRASP).parent_path().parent_path() / "share/graspd/console/three")) {
      return "chromium, or what npm fetches, is not there: deploy/install-deps --console brings it";
    }
    return {};
  }
  static fs::path flights() { return shared_->folder.path() / "flights"; }
  static ConsoleProcess console(int port = 0) {
    return {flights(), shared_->server->data_endpoint, port};
  }

  /// Asks the server what was asked before, in the name of a cell.
  static void ask(const std::string& cell) {
    static std::size_t turn = 0;
    const FlightRecord& asked = shared_->recorded[turn++ % shared_->recorded.size()];
    const auto envelope = codec::with_header(std::as_bytes(std::span(asked.request)),
                                             {client::new_request_id(), 1, cell, 30'000});
    client::ClientOptions options;
    options.cell = cell;
    const auto answer = client::Client({shared_->server->data_endpoint}, options)
                            .ask_again(envelope.value(), asked.depth_image, 30s);
    EXPECT_TRUE(answer) << answer.error().message;
  }
  /// A record such as the server writes, without the time that planning takes.
  static void copy_flight(const std::string& folder_name, const std::string& cell,
                          std::uint64_t n) {
    FlightRecord flight = shared_->recorded[n % shared_->recorded.size()];
    flight.cell = cell;
    flight.stamp_s =
        std::chrono::duration<double>(std::chrono::system_clock::now().time_since_epoch()).count();
    const fs::path folder = shared_->folder.path() / folder_name / cell;
    const auto name = [&](std::uint64_t i) {
      return folder / fmt::format("2026-11-23T00-00-00.{:06}Z_{:032x}.flight", i, i);
    };
    fs::create_directories(folder);
    const fs::path part = folder / "next.part";
    std::ofstream(part, std::ios::binary) << codec::encode_flight(flight);
    fs::rename(part, name(n));
    if (n >= 100) fs::remove(name(n - 100));
  }

  static std::vector<std::string> pictures() {
    const char* folder = getenv("GRASPD_CONSOLE_PICTURES");
    return folder == nullptr ? std::vector<std::string>{} : std::vector<std::string>{folder};
  }

  /// \param hear is told each line that the scenario prints
  static void run_scenario(
      const std::string& name, const ConsoleProcess& console,
      const std::vector<std::string>& more = {},
      const std::function<void(const std::string&)>& hear = [](const std::string&) {}) {
    std::vector<std::string> words{"env", "NODE_MODULES=" + kNodeModules, "node",
                                   fmt::format("{}/tests/console/page/{}.mjs", kSource, name),
                                   console.url};
    words.insert(words.end(), more.begin(), more.end());
    Child scenario(words);
    std::string output;
    for (std::string line; !(line = scenario.line()).empty(); output += line) hear(line);
    fmt::print("{}", output);
    EXPECT_EQ(scenario.end(), 0) << output;
  }

  struct Shared {
    TemporaryFolder folder;
    std::unique_ptr<ServeProcess> server;
    std::vector<FlightRecord> recorded;
  };
  static inline std::unique_ptr<Shared> shared_;
};

TEST_F(ConsolePageTest, LoadsInASecond) { run_scenario("loads", console()); }

TEST_F(ConsolePageTest, APlanAppearsWithin200MsOfItsAnswer) {
  const Meanwhile asking(400ms, [] { ask("tees"); });
  run_scenario("live", console(), {"16"});
}

TEST_F(ConsolePageTest, NothingOverlapsAndAxeFindsNothingSerious) {
  run_scenario("layout", console(), pictures());
}

TEST_F(ConsolePageTest, IsUsedWithMouseAndKeys) { run_scenario("use", console()); }

// Of one plan the arm takes the second grasp, of the next one none.
TEST_F(ConsolePageTest, SaysWhatTheArmCouldNotReach) {
  const fs::path records = shared_->folder.path() / "records";
  auto recorder = record::RunRecorder::create(records, "tees", std::chrono::system_clock::now(),
                                              /*keep_frames=*/false)
                      .value();
  for (const std::uint64_t n : {1, 2}) {
    copy_flight("out_of_reach", "tees", n);
    const auto& bytes = shared_->recorded[n % shared_->recorded.size()].answer;
    const auto answered = codec::decode_answer(std::as_bytes(std::span(bytes)));
    const auto& answer = std::get<PlanAnswer>(answered.value().body);
    ASSERT_GT(answer.grasps.size(), 1u);
    agent::PickRecord record;
    record.frame_n = n;
    record.request_id = fmt::format("{:032x}", n);
    record.outcome = n == 1 ? Outcome::kPlanned : Outcome::kNoneReachable;
    record.grasps_n = answer.grasps.size();
    const std::size_t passed_over_n = n == 1 ? 1 : answer.grasps.size();
    for (std::size_t rank = 1; rank <= passed_over_n; ++rank) {
      const Grasp& grasp = answer.grasps[rank - 1];
      record.passed_over.push_back({rank, grasp.object_id, "tee", grasp.pick_point,
                                    "approach: joint_3 would be at 2.9 rad, after 12 mm"});
    }
    if (n == 1) {
      record.chosen = agent::ChosenGrasp{1, 2, "tee", answer.grasps[1], {}};
      record.verdict = agent::Verdict::kPlaced;
    } else {
      record.message = "the arm can take none of the grasps";
    }
    ASSERT_TRUE(recorder.finished(record));
  }
  run_scenario(
      "unreachable",
      {shared_->folder.path() / "out_of_reach", shared_->server->data_endpoint, 0, records},
      pictures());
}

TEST_F(ConsolePageTest, ListsAHundredCells) {
  for (int n = 0; n < 100; ++n) copy_flight("many", fmt::format("cell_{}", n), 0);
  run_scenario("many", {shared_->folder.path() / "many", shared_->server->data_endpoint});
}

TEST_F(ConsolePageTest, ADeadConsoleIsSaidAndComesBack) {
  auto first = std::make_unique<ConsoleProcess>(flights(), shared_->server->data_endpoint);
  const int port = first->port();
  const ConsoleProcess& shown = *first;
  std::unique_ptr<ConsoleProcess> second;
  run_scenario("dead", shown, {}, [&](const std::string& line) {
    if (line == "kill\n") first->end();
    if (line == "restart\n")
      second = std::make_unique<ConsoleProcess>(flights(), shared_->server->data_endpoint, port);
    if (line == "plan\n") ask("tees");
  });
}

// GRASPD_CONSOLE_SECONDS=600 is the ten minutes of the target.
TEST_F(ConsolePageTest, ThirtyFramesASecondTakeNoMoreMemory) {
  const char* said = getenv("GRASPD_CONSOLE_SECONDS");
  std::uint64_t n = 0;
  const Meanwhile recording(33ms, [&] { copy_flight("fast", "fast", n++); });
  const ConsoleProcess fast(shared_->folder.path() / "fast", shared_->server->data_endpoint);
  double before_mib = 0;
  run_scenario("fast", fast, {said == nullptr ? "6" : said}, [&](const std::string& line) {
    if (line == "settled\n") before_mib = fast.resident_mib();
  });
  const double after_mib = fast.resident_mib();
  fmt::print("the console holds {:.1f} MiB, {:.1f} before\n", after_mib, before_mib);
  EXPECT_LT(after_mib, before_mib + 16);
}

}  // namespace
}  // namespace graspd::testing
