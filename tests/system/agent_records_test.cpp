#include "agent_fixture.hpp"

namespace graspd::testing {
namespace {

using ::testing::AllOf;
using ::testing::ContainsRegex;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::SizeIs;

class AgentRecordsTest : public AgentTest {
 protected:
  static json read_json(const std::filesystem::path& path) {
    std::ifstream file(path);
    return json::parse(file);
  }
  Finished report(const std::filesystem::path& runs) const {
    return run(fmt::format("{} report {}", ROBOT_AGENT, runs.string()));
  }
};

TEST_F(AgentRecordsTest, ARunIsKeptWithAllThatLedToIt) {
  const auto bars = three_bars();
  const DepthFrame second = frame_of({bars[1], bars[2]});
  const auto scene = write_bop({frame_of(bars), second, frame_of({})});
  ASSERT_EQ(agent(write_config("bop", scene, "bar")).exit_code, 0);

  const auto kept = run_folder("bop");
  EXPECT_EQ(read_json(kept / "run.json").at("state"), "DONE");
  EXPECT_THAT(read_json(kept / "run.json").at("reason").get<std::string>(), HasSubstr("BIN_EMPTY"));
  const json request = read_json(kept / "requests/000001.json");
  EXPECT_EQ(request.at("last_plan").at("objects").size(), 3u);
  EXPECT_EQ(read_json(kept / "answers/000001.json").at("outcome"), "UNCHANGED");
  const json pick = picks("bop").at(1);
  EXPECT_EQ(pick.at("ms").at("steps").at(0).at(0), "open");
  EXPECT_GE(pick.at("end_s").get<double>(), pick.at("start_s").get<double>());

  // The frames are a scene like any other: they can be evaluated, and replayed.
  const auto frames = BopScene::open(kept / "frames");
  ASSERT_TRUE(frames) << frames.error().message;
  const auto image = frames->read(1);
  ASSERT_TRUE(image) << image.error().message;
  EXPECT_EQ(image->frame.depth, second.depth);
  EXPECT_EQ(image->frame.camera, second.camera);
  ASSERT_TRUE(image->bin);
  EXPECT_NEAR(image->bin->inner_size_m.x(), 0.4, 1e-9);
}

TEST_F(AgentRecordsTest, FramesAreNotKeptWhereNobodyWantsThem) {
  const auto scene = write_bop({frame_of(three_bars())});
  ASSERT_EQ(agent(write_config("bop", scene, "bar", "keep_frames: false\n")).exit_code, 0);
  EXPECT_FALSE(std::filesystem::exists(run_folder("bop") / "frames"));
  EXPECT_TRUE(std::filesystem::exists(run_folder("bop") / "requests/000000.json"));
}

/// The walls of the recorded bin.
std::vector<Block> walls() {
  constexpr double kThick_m = 0.006;
  const Eigen::Vector3d inner_m(0.4, 0.3, 0.15);
  std::vector<Block> walls;
  for (const int axis : {0, 1}) {
    for (const int side : {-1, 1}) {
      Block& wall = walls.emplace_back();
      wall.size_m = inner_m;
      wall.size_m[axis] = kThick_m;
      wall.T_camera_block.translation().z() = kHeight_m - inner_m.z() / 2;
      wall.T_camera_block.translation()[axis] = side * (inner_m[axis] + kThick_m) / 2;
    }
  }
  return walls;
}

TEST_F(AgentRecordsTest, ABinThatHasDriftedRaisesTheAlarmOnce) {
  const std::vector<Block> bin = walls();
  const auto with = [&](std::vector<Block> bars) {
    bars.insert(bars.end(), bin.begin(), bin.end());
    return frame_of(bars);
  };
  const auto bars = three_bars();
  const auto scene =
      write_bop({with(bars), with({bars[1], bars[2]}), with({bars[1]}), with({bars[2]})});
  const Finished finished =
      agent(write_config("bop", scene, "bar",
                         "drift_alarm: {limit_m: 0.008, answers_n: 2}\n"
                         "T_base_camera: [1, 0, 0, 0, 0, -1, 0, 0, 0, 0, -1, 0.75, 0, 0, 0, 1]\n"
                         "bin: {T_base_bin: [1, 0, 0, 0.012, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1],\n"
                         "      inner_size_m: [0.4, 0.3, 0.15]}\n"));
  EXPECT_THAT(finished.output,
              ContainsRegex("warning bop: the bin was 1[12]\\.[0-9] to 1[123]\\.[0-9] "
                            "mm off in 2 frames in a row"));
  std::vector<bool> is_alarmed;
  for (const json& pick : picks("bop")) is_alarmed.push_back(pick.contains("alarm"));
  EXPECT_THAT(is_alarmed, ElementsAre(false, true, false, false));
  EXPECT_THAT(report(run_folder("bop")).output, ContainsRegex("drift alarms +1\n"));
}

TEST_F(AgentRecordsTest, TheReportSumsUpOneRunAndMany) {
  const auto bars = three_bars();
  const auto scene = write_bop({frame_of(bars), frame_of({bars[1], bars[2]}), frame_of({})});
  const auto config = write_config("bop", scene, "bar");
  ASSERT_EQ(agent(config).exit_code, 0);
  const Finished one = report(run_folder("bop"));
  EXPECT_EQ(one.exit_code, 0) << one.output;
  EXPECT_THAT(
      one.output,
      AllOf(ContainsRegex("placed +2\n"), ContainsRegex("success +100.0 %\n"),
            ContainsRegex("95 % confidence +34.2 to 100.0 %\n"),
            ContainsRegex("picks per hour +[0-9]+\n"),
            ContainsRegex("planning, of the cycle +[0-9.]+ %\n"),
            ContainsRegex("drift alarms +0\n"), ContainsRegex("bar +2 +2 +0 +0 +0 +100.0 %\n"),
            ContainsRegex("BIN_EMPTY: .* 1\n"), ContainsRegex("pre_grasp +[0-9.]+"),
            HasSubstr("DONE: BIN_EMPTY"), Not(HasSubstr("passed over"))));

  ASSERT_EQ(agent(config, "--frames 1").exit_code, 0);
  const Finished both = report(folder.path() / "bop_records");
  EXPECT_THAT(both.output,
              AllOf(ContainsRegex("placed +3\n"), HasSubstr("no more frames after 1")));
  EXPECT_THAT(run(fmt::format("{} report --markdown {}", ROBOT_AGENT,
                              (folder.path() / "bop_records").string()))
                  .output,
              HasSubstr("| part "));
}

TEST_F(AgentRecordsTest, AReportOfNothingSaysWhatIsMissing) {
  const Finished nowhere = report("/no/such/folder");
  EXPECT_EQ(nowhere.exit_code, 2);
  EXPECT_THAT(nowhere.output, HasSubstr("/no/such/folder: no run here"));
}

TEST_F(AgentRecordsTest, AServerThatIsAwayIsNoMatterWhereThereIsAnother) {
  const auto scene = write_bop({frame_of(three_bars())});
  const Finished finished =
      agent(write_config("bop", scene, "bar"),
            "--server tcp://127.0.0.1:9 --server " + shared_->server->data_endpoint);
  EXPECT_EQ(finished.exit_code, 0) << finished.output;
  EXPECT_THAT(all(picks("bop"), "verdict"), ElementsAre("PLACED"));
}

TEST_F(AgentRecordsTest, WhatTheServerCouldNotAnswerIsKeptToo) {
  const auto scene = write_bop({frame_of(three_bars())});
  EXPECT_EQ(agent(write_config("bop", scene, "bolt")).exit_code, 1);
  const auto kept = run_folder("bop");
  EXPECT_EQ(read_json(kept / "requests/000000.json").at("parts").at(0).at("id"), "bolt");
  EXPECT_FALSE(std::filesystem::exists(kept / "answers/000000.json"));
  EXPECT_EQ(read_json(kept / "run.json").at("state"), "STOPPED");
}

TEST_F(AgentRecordsTest, TheOperatorAnswersByLine) {
  const auto scene = write_bop({frame_of({}), frame_of({}), frame_of(three_bars())});
  const auto config = write_config("bop", scene, "bar", "reactions: {on_bin_empty: ask}\n");
  const Finished finished = run(fmt::format("printf '\\nstop\\n' | {} run --config {} --out {}",
                                            ROBOT_AGENT, config.string(), folder.path().string()));
  EXPECT_EQ(finished.exit_code, 0) << finished.output;
  EXPECT_THAT(finished.output, AllOf(HasSubstr("waiting: press Enter"),
                                     HasSubstr("the operator said stop: BIN_EMPTY")));
  EXPECT_THAT(picks("bop"), SizeIs(2));
}

TEST_F(AgentRecordsTest, TheOperatorAnswersBySignalWhereThereIsNoTerminal) {
  const auto scene = write_bop({frame_of({}), frame_of(three_bars())});
  const auto config = write_config("bop", scene, "bar", "reactions: {on_bin_empty: ask}\n");
  const Finished finished = run(
      fmt::format("cd {2}; mkfifo log; {0} run --config {1} >out 2>log </dev/null & exec 3<log; "
                  "while read -r line <&3; do case $line in *waiting:*) break;; esac; done; "
                  "kill -USR1 $!; cat <&3; wait $!",
                  ROBOT_AGENT, config.string(), folder.path().string()));
  EXPECT_EQ(finished.exit_code, 0) << finished.output;
  EXPECT_THAT(finished.output, HasSubstr("1 parts placed"));
}

TEST_F(AgentRecordsTest, ToStirTheBinMustBeKnown) {
  const auto rawlog = write_rawlog({frame_of(three_bars())});
  const Finished finished =
      agent(write_config("rawlog", rawlog, "bar", "reactions: {on_all_in_collision: stir}\n"));
  EXPECT_EQ(finished.exit_code, 2);
  EXPECT_THAT(finished.output, HasSubstr("add a bin section"));
}

}  // namespace
}  // namespace graspd::testing
