#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>

#include "client_support.hpp"
#include "graspd/codec/codec.hpp"
#include "graspd/formats/bop.hpp"
#include "graspd/recordings/rawlog.hpp"
#include "serve_process.hpp"
#include "temporary_folder.hpp"

// `grasp load` as its users see it: real processes, the servers' planner scripted.
namespace graspd {
namespace {

using ::testing::AllOf;
using testing::Finished;
using ::testing::HasSubstr;
using ::testing::Not;
using testing::ServeProcess;
using testing::TemporaryFolder;

constexpr int kFrames_n = 5;
const std::string kShort = " --warm-up-s 0.1 --window-s 0.25 --max-windows 4";

class LoadTest : public ::testing::Test {
 protected:
  void SetUp() override {
    auto rawlog = RawlogWriter::create(file("frames.rawlog")).value();
    for (int i = 0; i < kFrames_n; ++i) {
      ASSERT_TRUE(rawlog.add(example_frame(64, 48), 100 + 0.02 * i));
    }
    ASSERT_TRUE(rawlog.finish());
  }
  std::string file(const std::string& name) const { return folder_.path() / name; }
  /// Asks the server for the script of this name.
  std::string recording(const std::string& script = "echo") const {
    return file("frames.rawlog") + "=" + script;
  }
  static Finished load(const std::string& words, const std::string& endpoint) {
    return testing::run(std::string(GRASP) + " load " + words + kShort + " --server " + endpoint);
  }
  /// Servers under load, one of them killed in the midst of it.
  void expect_no_failure_without(const ServeProcess& leaving, const std::string& servers,
                                 const std::string& before = "") const {
    const std::string command = before + GRASP + " load " + recording() +
                                " --cells 4 --rate 50 --warm-up-s 0.2 --window-s 0.3" +
                                " --max-windows 6 " + servers + " --out " + file("out") + " 2>&1";
    // NOLINTNEXTLINE(bugprone-command-processor): the command is the test's own.
    FILE* const pipe = popen(command.c_str(), "r");
    ASSERT_NE(pipe, nullptr);
    std::string output;
    bool has_left = false;
    for (int byte = fgetc(pipe); byte != EOF; byte = fgetc(pipe)) {
      output += static_cast<char>(byte);
      if (has_left || output.find("window 1") == std::string::npos) continue;
      leaving.kill(SIGKILL);
      has_left = true;
    }
    EXPECT_EQ(pclose(pipe), 0) << output;
    EXPECT_TRUE(has_left) << output;
    EXPECT_EQ(read_json("out/load.json").at("runs").at(0).at("ended").size(), 1u) << output;
  }
  nlohmann::json read_json(const std::string& name) const {
    return nlohmann::json::parse(std::ifstream(file(name)));
  }

  TemporaryFolder folder_;
};

TEST_F(LoadTest, ManyCellsAtARateAreServedAndCounted) {
  ServeProcess server({"--workers", "2"});
  ASSERT_TRUE(server.wait_ready());
  const Finished finished =
      load(recording() + " --cells 4 --rate 100 --out " + file("out"), server.data_endpoint);
  EXPECT_EQ(finished.exit_code, 0) << finished.output;
  EXPECT_THAT(finished.output, AllOf(HasSubstr("load_4"), Not(HasSubstr("load_5"))));
  const auto json = read_json("out/load.json");
  const auto& run = json.at("runs").at(0);
  EXPECT_EQ(run.at("ok_n"), run.at("asked_n"));
  EXPECT_NEAR(run.at("asked_fps"), 100, 5);
  EXPECT_GE(run.at("jain"), 0.98);
  EXPECT_EQ(run.at("cells").size(), 4u);
  EXPECT_GT(run.at("mean_ms").at("transport"), 0);

  // A row for each request, in the columns of the first.
  std::ifstream csv(file("out/load.csv"));
  std::string line;
  std::getline(csv, line);
  const auto columns_n = std::count(line.begin(), line.end(), ',');
  EXPECT_THAT(line, HasSubstr("queue_ms,decode_ms,script_ms"));
  std::size_t rows_n = 0;
  for (; std::getline(csv, line); ++rows_n) {
    EXPECT_EQ(std::count(line.begin(), line.end(), ','), columns_n);
  }
  EXPECT_GE(rows_n, run.at("asked_n").get<std::size_t>());
  std::getline(std::ifstream(file("out/load.svg")), line, '\0');
  EXPECT_THAT(line, AllOf(HasSubstr("<svg"), HasSubstr("</svg>"), Not(HasSubstr("nan"))));
}

TEST_F(LoadTest, ARecordingThatSaysWhatWasAskedIsAskedAtItsOwnPace) {
  ServeProcess server({"--workers", "2"});
  ASSERT_TRUE(server.wait_ready());
  auto rawlog = RawlogWriter::create(file("asked.rawlog")).value();
  for (int i = 0; i < kFrames_n; ++i) {
    RecordedFrame recorded{example_frame(64, 48), 100 + 0.02 * i};
    recorded.request = codec::to_json(example_request({"echo"}), false);
    ASSERT_TRUE(rawlog.add(recorded));
  }
  ASSERT_TRUE(rawlog.finish());
  const Finished finished =
      load(file("asked.rawlog") + " --cells 2 --pace recorded --out " + file("out"),
           server.data_endpoint);
  EXPECT_EQ(finished.exit_code, 0) << finished.output;
  const auto run = read_json("out/load.json").at("runs").at(0);
  EXPECT_NEAR(run.at("asked_fps"), 100, 10) << "two cells with a frame each 20 ms";
  EXPECT_EQ(run.at("ended").size(), 1u) << finished.output;
}

TEST_F(LoadTest, LatencyCountsFromThePlannedInstantHoweverSlowTheServer) {
  ServeProcess server({"--workers", "1"});
  ASSERT_TRUE(server.wait_ready());
  // One worker of 20 ms is asked twice as often as it can answer, by cells with room for two each.
  const Finished finished = load(
      recording("sleep_20") + " --cells 8 --rate 100 --out " + file("out"), server.data_endpoint);
  const auto run = read_json("out/load.json").at("runs").at(0);
  EXPECT_NEAR(run.at("asked_fps"), 100, 5) << "the server slowed the load down";
  EXPECT_LE(run.at("goodput_fps"), 52);
  EXPECT_GE(run.at("latency_ms").at("p50"), 100) << "not the time in the queue";
  EXPECT_TRUE(run.at("ended").contains("SUPERSEDED")) << finished.output;
}

TEST_F(LoadTest, TheCapacityIsFound) {
  ServeProcess server({"--workers", "2"});
  ASSERT_TRUE(server.wait_ready());
  const Finished finished =
      load(recording("sleep_20") + " --cells 6 --find-capacity --out " + file("out"),
           server.data_endpoint);
  EXPECT_EQ(finished.exit_code, 0) << finished.output;
  // Two workers of 20 ms can't do more anywhere; how much less they do is a matter of the machine.
  // Windows are so short that one answer more or less is 4 %.
  const auto json = read_json("out/load.json");
  const double capacity_fps = json.at("capacity_fps");
  EXPECT_LE(capacity_fps, 105) << finished.output;
  // What was found has been seen: answers kept up at that rate, and latency is told below it.
  const auto& runs = json.at("runs");
  const auto rate_is = [&](double rate_fps) {
    return std::find_if(runs.begin(), runs.end(), [=](const nlohmann::json& run) {
      return run.at("is_open") && std::abs(run.at("rate_fps").get<double>() - rate_fps) < 1e-9;
    });
  };
  const auto found = rate_is(capacity_fps);
  ASSERT_NE(found, runs.end()) << finished.output;
  EXPECT_GE(found->at("goodput_fps").get<double>(), 0.98 * found->at("asked_fps").get<double>());
  EXPECT_NE(rate_is(0.8 * capacity_fps), runs.end()) << finished.output;
}

TEST_F(LoadTest, ServersMayComeAndGo) {
  ServeProcess staying({"--workers", "1"});
  ASSERT_TRUE(staying.wait_ready());
  auto leaving = std::make_unique<ServeProcess>(std::vector<std::string>{"--workers", "1"});
  ASSERT_TRUE(leaving->wait_ready());
  expect_no_failure_without(
      *leaving, "--server " + staying.data_endpoint + " --server " + leaving->data_endpoint);
}

TEST_F(LoadTest, OfTheServersOfOneNameOneMayGo) {
  if (testing::run("unshare --mount true").exit_code != 0) {
    GTEST_SKIP() << "an /etc/hosts of its own needs root";
  }
  ServeProcess staying({"--workers", "1"});
  ASSERT_TRUE(staying.wait_ready());
  const std::string port = staying.data_endpoint.substr(staying.data_endpoint.rfind(':') + 1);
  ServeProcess leaving({"--workers", "1", "--endpoint", "tcp://127.0.0.2:" + port});
  ASSERT_TRUE(leaving.wait_ready());
  const std::string hosts =
      folder_.write("hosts", "127.0.0.1 graspd.test\n127.0.0.2 graspd.test\n").string();
  const std::string with_name =
      "unshare --mount sh -c 'mount --bind " + hosts + " /etc/hosts && exec \"$0\" \"$@\"' ";
  const std::string server = "--server tcp://graspd.test:" + port;
  const Finished health = testing::run(with_name + GRASP + " health " + server);
  EXPECT_EQ(health.exit_code, 0) << health.output;
  EXPECT_THAT(health.output,
              AllOf(HasSubstr(staying.data_endpoint), HasSubstr("tcp://127.0.0.2:" + port)));
  expect_no_failure_without(leaving, server, with_name);
}

TEST_F(LoadTest, WithoutAServerEverythingIsUnavailableAndSaidToBe) {
  const Finished finished = load(recording() + " --rate 50 --budget-ms 300", "tcp://127.0.0.1:1");
  EXPECT_EQ(finished.exit_code, 3) << finished.output;
  EXPECT_THAT(finished.output,
              AllOf(HasSubstr("not one request was answered OK"), HasSubstr("UNAVAILABLE")));
}

TEST_F(LoadTest, ARateThatThisMachineCannotSendIsSaid) {
  ServeProcess server({"--workers", "1"});
  ASSERT_TRUE(server.wait_ready());
  const Finished finished =
      load(recording() + " --rate 1000000 --budget-ms 300", server.data_endpoint);
  EXPECT_THAT(finished.output, HasSubstr("is more than this machine can send"));
}

TEST_F(LoadTest, WhatCannotBeSentIsRefusedWithASentence) {
  const auto refusal = [&](const std::string& words) {
    const Finished finished = load(words, "tcp://127.0.0.1:1");
    EXPECT_EQ(finished.exit_code, 2) << finished.output;
    return finished.output;
  };
  EXPECT_THAT(refusal(file("none.rawlog") + "=tee"), HasSubstr("there is no such rawlog"));
  EXPECT_THAT(refusal(file("frames.rawlog")), HasSubstr("grasp load: FILE=PART"));
  std::ofstream(file("empty.rawlog")) << "";
  EXPECT_THAT(refusal(file("empty.rawlog") + "=tee"), HasSubstr("there is no frame in it"));
  EXPECT_THAT(refusal(recording() + " --rate 5 --find-capacity"), HasSubstr("excludes"));
  EXPECT_THAT(refusal(recording() + " --pace recorded --find-capacity"),
              HasSubstr("has none of them"));
  EXPECT_THAT(refusal(recording() + " --keys " + file("")), HasSubstr("--server-key"));
}

TEST_F(LoadTest, OfADamagedRecordingTheFramesBeforeTheDamageAreUsed) {
  ServeProcess server({"--workers", "1"});
  ASSERT_TRUE(server.wait_ready());
  std::filesystem::resize_file(file("frames.rawlog"),
                               std::filesystem::file_size(file("frames.rawlog")) - 20);
  const Finished finished = load(recording() + " --rate 50", server.data_endpoint);
  EXPECT_EQ(finished.exit_code, 0) << finished.output;
  EXPECT_THAT(finished.output, HasSubstr("frames before are used"));
}

TEST_F(LoadTest, OfALongRecordingTheFirstFramesAreUsed) {
  ServeProcess server({"--workers", "1"});
  ASSERT_TRUE(server.wait_ready());
  auto rawlog = RawlogWriter::create(file("long.rawlog")).value();
  for (int i = 0; i < 150; ++i) ASSERT_TRUE(rawlog.add(example_frame(), i));
  ASSERT_TRUE(rawlog.finish());
  const Finished finished = load(file("long.rawlog") + "=echo --rate 50", server.data_endpoint);
  EXPECT_EQ(finished.exit_code, 0) << finished.output;
  EXPECT_THAT(finished.output, HasSubstr("the first 100 frames are used"));
}

}  // namespace
}  // namespace graspd
