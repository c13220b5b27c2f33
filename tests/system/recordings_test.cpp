#include <gmock/gmock.h>

#include <chrono>
#include <fstream>

#include "agent_fixture.hpp"
#include "graspd/client/client.hpp"
#include "graspd/recorded/questions.hpp"

// Recordings and the flight recorder through the real programs: what is kept can be asked again.
namespace graspd::testing {
namespace {

namespace fs = std::filesystem;
using client::Client;
using std::chrono::seconds;
using ::testing::AllOf;
using ::testing::ContainsRegex;
using ::testing::HasSubstr;
using ::testing::Not;

class RecordingsTest : public AgentTest {
 protected:
  RecordingsTest() {
    request_.T_base_camera = T_base_camera_above(kHeight_m);
    // No matrix of nice numbers: its last bits must survive as well.
    request_.T_base_camera.rotate(Eigen::AngleAxisd(1e-3, Eigen::Vector3d(1, 2, 3).normalized()));
    request_.bin = Bin{Eigen::Isometry3d::Identity(), {0.4, 0.3, 0.1}, 0.003};
    request_.parts = {{"bar", 0}};
  }
  /// A server of its own with a flight recorder.
  std::vector<std::string> recording_server(const std::string& more = "") const {
    const auto config = folder.write(
        "server.yaml", fmt::format("parts: {}\nflight_recorder:\n  folder: {}\n{}",
                                   (shared_->folder.path() / "parts").string(), flights(), more));
    return {"--config", config.string(), "--workers", "1"};
  }
  std::string flights() const { return path("flights"); }
  std::string path(const std::string& name) const { return (folder.path() / name).string(); }
  static Finished grasp(const std::string& words, const ServeProcess& server) {
    return run(fmt::format("{} {} --server {}", GRASP, words, server.data_endpoint));
  }
  static Finished grasp(const std::string& words) { return grasp(words, *shared_->server); }
  Finished record(const std::string& kind, const fs::path& recording, const std::string& more) {
    return run(fmt::format("{} record --config {} --out {} {}", ROBOT_AGENT,
                           write_config(kind, recording, "bar").string(), path("out.rawlog"),
                           more));
  }
  static void stop(ServeProcess& server) {
    server.kill(SIGTERM);
    EXPECT_EQ(server.wait(), 0);
  }
  /// All flights that are in the folder; each must be whole.
  std::size_t whole_flights_n() const {
    auto questions = recorded::open_questions(flights());
    std::size_t n = 0;
    while (questions) {
      const auto question = (*questions)->next();
      EXPECT_TRUE(question) << question.error().message;
      if (!question || !*question) break;
      ++n;
    }
    return n;
  }

  PlanRequest request_;
};

TEST_F(RecordingsTest, WhatAnAgentsCameraSeesIsRecordedAndAskedAgain) {
  const auto scene = write_bop({frame_of(three_bars()), frame_of({})});
  const Finished recorded = record("bop", scene, "");
  ASSERT_EQ(recorded.exit_code, 0) << recorded.output;
  EXPECT_THAT(recorded.output, HasSubstr("2 frames"));

  const std::string file = path("out.rawlog");
  const Finished replayed = grasp("replay " + file + " --out " + path("old.jsonl"));
  EXPECT_EQ(replayed.exit_code, 0) << replayed.output;
  EXPECT_THAT(replayed.output, AllOf(HasSubstr("frame 0      PLANNED"),
                                     HasSubstr("frame 1      BIN_EMPTY"), HasSubstr("2 answers")));
  EXPECT_EQ(grasp("replay " + file + " --out " + path("new.jsonl")).exit_code, 0);
  const std::string diff = std::string(GRASP) + " replay --diff " + path("old.jsonl") + " ";
  const Finished same = run(diff + path("new.jsonl"));
  EXPECT_EQ(same.exit_code, 0) << same.output;
  EXPECT_THAT(same.output, HasSubstr("2 answers, 2 the same to the bit"));
}

TEST_F(RecordingsTest, AServerThatAnswersOtherwiseIsFoundOut) {
  ASSERT_EQ(record("bop", write_bop({frame_of(three_bars())}), "").exit_code, 0);
  ASSERT_EQ(grasp("replay " + path("out.rawlog") + " --out " + path("old.jsonl")).exit_code, 0);
  ServeProcess other(
      recording_server("perception:\n  preprocess:\n    wall_margin_m: 0.02\n"
                       "  grasp:\n    max_grasps_n: 1\n"));
  ASSERT_TRUE(other.wait_ready());
  ASSERT_EQ(grasp("replay " + path("out.rawlog") + " --out " + path("new.jsonl"), other).exit_code,
            0);
  const Finished diff =
      run(fmt::format("{} replay --diff {} {}", GRASP, path("old.jsonl"), path("new.jsonl")));
  EXPECT_EQ(diff.exit_code, 5) << diff.output;
  EXPECT_THAT(diff.output, AllOf(HasSubstr("differs since preprocess: after_passthrough_n"),
                                 HasSubstr("→ gone"), HasSubstr("another server: config")));

  // Two recordings have nothing to compare.
  folder.write("old.jsonl", "");
  const Finished shorter =
      run(fmt::format("{} replay --diff {} {}", GRASP, path("old.jsonl"), path("new.jsonl")));
  EXPECT_EQ(shorter.exit_code, 2);
  EXPECT_THAT(shorter.output, HasSubstr("old.jsonl ends after 0 answers"));
}

TEST_F(RecordingsTest, FlightsAreReplayedToTheBitAndBecomeARawlogThatIs) {
  {
    ServeProcess server(recording_server("  keep: all\n"));
    ASSERT_TRUE(server.wait_ready());
    client::ClientOptions options;
    options.cell = "bars";
    Client client({server.data_endpoint}, options);
    for (const double angle_rad : {0.1, 0.5, 0.9}) {
      const auto frame = frame_of({bar_at(0.05, 0.03, angle_rad, kBar_m)});
      ASSERT_TRUE(client.plan(frame, request_, seconds(30)));
    }
    stop(server);
  }
  EXPECT_EQ(whole_flights_n(), 3u);
  const Finished again = grasp("replay " + flights());
  EXPECT_EQ(again.exit_code, 0) << again.output;
  EXPECT_THAT(again.output, HasSubstr("3 answers, 3 the same to the bit"));

  const Finished recorded =
      run(fmt::format("{} record {} --out {}", GRASP, flights(), path("bars.rawlog")));
  EXPECT_EQ(recorded.exit_code, 0) << recorded.output;
  EXPECT_THAT(recorded.output, HasSubstr("3 frames of cell 'bars'"));
  const Finished from_rawlog = grasp("replay " + path("bars.rawlog"));
  EXPECT_EQ(from_rawlog.exit_code, 0) << from_rawlog.output;
  EXPECT_THAT(from_rawlog.output, HasSubstr("3 answers, 3 the same to the bit"));
  // An agent picks from it as from any recording.
  const Finished picked = agent(write_config("rawlog", path("bars.rawlog"), "bar"));
  EXPECT_EQ(picked.exit_code, 0) << picked.output;
}

TEST_F(RecordingsTest, ACellIsRecordedWhileItWorks) {
  ServeProcess server(recording_server("  keep: all\n"));
  ASSERT_TRUE(server.wait_ready());
  const auto scene = write_bop({frame_of(three_bars()), frame_of({})});
  const std::string out = path("live.rawlog");
  // The recorder of the running cell starts before there is anything to record.
  const Finished finished = run(fmt::format(
      "{} record {} --out {} --follow & follower=$!; {} run --config {} --out {} --server {}; "
      "until [ $(ls {}/*/*.flight 2>/dev/null | wc -l) -ge 2 ]; do sleep 0.1; done; sleep 0.5; "
      "kill $follower; wait $follower",
      GRASP, flights(), out, ROBOT_AGENT, write_config("bop", scene, "bar").string(),
      folder.path().string(), server.data_endpoint, flights()));
  EXPECT_EQ(finished.exit_code, 0) << finished.output;
  EXPECT_THAT(finished.output, HasSubstr("2 frames of cell 'bop'"));
  const Finished replayed = grasp("replay " + out, server);
  EXPECT_EQ(replayed.exit_code, 0) << replayed.output;
  EXPECT_THAT(replayed.output, HasSubstr("2 answers, 2 the same to the bit"));
}

TEST_F(RecordingsTest, APlanIsKeptWhereItAsksForIt) {
  ServeProcess server(recording_server());
  ASSERT_TRUE(server.wait_ready());
  const std::string plan =
      fmt::format("plan --depth {} --camera {} --part bar ",
                  write_frame(folder, "frame.png", frame_of(three_bars())).string(),
                  write_camera(folder, "camera.yaml", kinect_v2(), kHeight_m).string());
  EXPECT_EQ(grasp(plan, server).exit_code, 0);
  EXPECT_EQ(grasp(plan + "--record", server).exit_code, 0);
  stop(server);
  EXPECT_EQ(whole_flights_n(), 1u);
}

TEST_F(RecordingsTest, AServerThatIsKilledWhileItWritesLeavesWholeFlightsAlone) {
  for (int round = 0; round < 3; ++round) {
    ServeProcess server(recording_server("  keep: all\n  per_cell_n: 5\n"));
    ASSERT_TRUE(server.wait_ready());
    Client client({server.data_endpoint});
    const auto frame = frame_of({bar_at(0.05, 0.03, 0.4, kBar_m)});
    for (int i = 0; i < 4; ++i) ASSERT_TRUE(client.plan(frame, request_, seconds(30)));
    server.kill(SIGKILL);  // the last one may be in the middle of being written
    server.wait();
    EXPECT_LE(whole_flights_n(), 5u);
    EXPECT_GE(whole_flights_n(), 3u);
  }
}

TEST_F(RecordingsTest, OfADamagedRecordingAllThatCanBeReadIsAsked) {
  const auto scene = write_bop({frame_of(three_bars()), frame_of({}), frame_of(three_bars())});
  ASSERT_EQ(record("bop", scene, "").exit_code, 0);
  const std::string file = path("out.rawlog");
  fs::resize_file(file, fs::file_size(file) - 1000);
  const Finished cut = grasp("replay " + file);
  EXPECT_EQ(cut.exit_code, 2) << cut.output;
  EXPECT_THAT(cut.output, AllOf(HasSubstr("frame 1      BIN_EMPTY"), Not(HasSubstr("frame 2")),
                                HasSubstr("2 answers"), HasSubstr("broken after 2 frames, at byte"),
                                HasSubstr("cut short or damaged")));
}

TEST_F(RecordingsTest, RecordingsThatAreNoneAreNamed) {
  folder.write("empty.rawlog", "");
  EXPECT_THAT(grasp("replay " + path("empty.rawlog")).output, HasSubstr("no frame is in it"));
  EXPECT_EQ(grasp("replay " + path("empty.rawlog")).exit_code, 2);
  EXPECT_THAT(grasp("replay " + path("no_such.rawlog")).output, HasSubstr("no such rawlog"));
  folder.write("text.rawlog", "by no means a recording");
  EXPECT_THAT(grasp("replay " + path("text.rawlog")).output, HasSubstr("broken after 0 frames"));
  // Ten gigabytes of nothing: read where it breaks, never as a whole.
  fs::resize_file(folder.write("huge.rawlog", ""), 10'000'000'000);
  EXPECT_THAT(grasp("replay " + path("huge.rawlog")).output, HasSubstr("broken after 0 frames"));
  EXPECT_EQ(run(fmt::format("{} replay", GRASP)).exit_code, 2);
}

TEST_F(RecordingsTest, MrptsOwnToolReadsWhatWeWrite) {
  if (run("command -v rawlog-edit").exit_code != 0) {
    GTEST_SKIP() << "rawlog-edit is not there: it is in Debian's mrpt-apps";
  }
  ASSERT_EQ(record("bop", write_bop({frame_of(three_bars()), frame_of({})}), "").exit_code, 0);
  const Finished info = run("rawlog-edit --info --input " + path("out.rawlog"));
  EXPECT_EQ(info.exit_code, 0) << info.output;
  EXPECT_THAT(info.output, ContainsRegex("number of objects +: 3\n"));  // with the request
  EXPECT_THAT(info.output, ContainsRegex("depth / +2 "));
}

TEST_F(RecordingsTest, ARecordingOfAnotherCameraIsRefused) {
  const std::string file = write_rawlog({frame_of(three_bars())}).string();
  CameraIntrinsics other = kinect_v2();
  other.width_px = 640;
  other.height_px = 480;
  const std::string camera = write_camera(folder, "other.yaml", other, kHeight_m).string();
  const Finished refused = grasp("replay " + file + " --part bar --camera " + camera);
  EXPECT_EQ(refused.exit_code, 2);
  EXPECT_THAT(refused.output, AllOf(HasSubstr("another camera"), HasSubstr("512 × 424")));
  const Finished plain = grasp("replay " + file);
  EXPECT_EQ(plain.exit_code, 2);
  EXPECT_THAT(plain.output, HasSubstr("--camera, --cell and --part"));
}

TEST_F(RecordingsTest, AFullDiskEndsARecordingWithASentence) {
  const auto scene = write_bop({frame_of(three_bars())});
  const Finished full = run(fmt::format("{} record --config {} --out /dev/full", ROBOT_AGENT,
                                        write_config("bop", scene, "bar").string()));
  EXPECT_EQ(full.exit_code, 1) << full.output;
  EXPECT_THAT(full.output, HasSubstr("is the disk full?"));
}

TEST_F(RecordingsTest, SigtermEndsARecordingThatCanBeRead) {
  const auto scene = write_bop({frame_of(three_bars())});
  const auto config = write_config("bop", scene, "bar");
  std::ifstream file(config);
  std::string text{std::istreambuf_iterator<char>(file), {}};
  folder.write("bop_cell.yaml", text.insert(text.find("camera: {") + 9, "loop: true, "));
  const Finished ended =
      run(fmt::format("{} record --config {} --out {} & recorder=$!; until [ $(stat -c %s {} "
                      "2>/dev/null || echo 0) -gt 200000 ]; do sleep 0.05; done; kill $recorder; "
                      "wait $recorder",
                      ROBOT_AGENT, config.string(), path("out.rawlog"), path("out.rawlog")));
  EXPECT_EQ(ended.exit_code, 0) << ended.output;
  auto rawlog = RawlogReader::open(path("out.rawlog"));
  std::size_t frames_n = 0;
  for (auto frame = rawlog->next(); frame && *frame; frame = rawlog->next()) ++frames_n;
  EXPECT_THAT(ended.output, HasSubstr(fmt::format(": {} frame", frames_n)));
}

}  // namespace
}  // namespace graspd::testing
