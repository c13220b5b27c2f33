#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "graspd/record/pick_json.hpp"
#include "graspd/record/recording_arm.hpp"
#include "pick_cycle_fixture.hpp"
#include "temporary_folder.hpp"

namespace graspd::record {
namespace {

using nlohmann::json;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::SizeIs;

class RecordsTest : public agent::PickCycleTest {
 protected:
  std::filesystem::path arm_path() const { return folder_.path() / "cell" / "arm.jsonl"; }

  static std::vector<json> read_lines(const std::filesystem::path& path) {
    std::vector<json> lines;
    std::ifstream file(path);
    for (std::string line; std::getline(file, line);) lines.push_back(json::parse(line));
    return lines;
  }

 private:
  testing::TemporaryFolder folder_;
};

TEST_F(RecordsTest, TheArmWritesDownTheFramesAndThenWhatItIsTold) {
  CellFrames frames{"cell 7", Eigen::Isometry3d::Identity(), Bin{}};
  frames.T_base_camera.translation().z() = 1.25;
  frames.bin->inner_size_m = {0.3, 0.2, 0.1};
  auto arm = RecordingArm::create(arm_path(), frames);
  ASSERT_TRUE(arm) << arm.error().message;

  script({agent::planned(), agent::planned()});
  agent::PickCycle cycle({camera, planner, *arm, *arm, clock}, task, observer);
  while (!cycle.is_over()) cycle.step();
  EXPECT_EQ(cycle.state(), agent::State::kDone);

  const std::vector<json> lines = read_lines(arm_path());
  EXPECT_EQ(lines.at(0).at("cell"), "cell 7");
  EXPECT_EQ(lines.at(0).at("T_base_camera").at(11), 1.25);
  EXPECT_EQ(lines.at(0).at("bin").at("inner_size_m").at(1), 0.2);
  EXPECT_EQ(lines.at(1).at("step"), "out_of_view");
  std::vector<std::string> steps;
  for (const json& line : lines) {
    if (line.value("pick", 0) == 2) steps.push_back(line.at("step"));
  }
  EXPECT_THAT(steps, ElementsAre("open", "pre_grasp", "approach", "close", "lift", "transfer",
                                 "place", "release", "retreat", "out_of_view"));
  const json& approach = lines.at(4);
  EXPECT_EQ(approach.at("path"), "straight");
  ASSERT_THAT(approach.at("T_base_grasp"), SizeIs(16));
  EXPECT_NEAR(approach.at("T_base_grasp").at(3).get<double>(), 0.1, 1e-12);  // x of object 1
  EXPECT_EQ(lines.at(2).at("opening_width_m"), 0.044);
}

TEST_F(RecordsTest, AfterTheGripperStirredItLetsGoAndThenAPickBeginsByOpeningIt) {
  auto arm = RecordingArm::create(arm_path(), {}).value();
  ASSERT_TRUE(arm.close());
  ASSERT_TRUE(arm.move({.step = agent::Step::kStirUp}));
  ASSERT_TRUE(arm.open(0.08));
  EXPECT_EQ(read_lines(arm_path()).back().at("step"), "release");
  ASSERT_TRUE(arm.move_out_of_view());
  ASSERT_TRUE(arm.open(0.04));
  EXPECT_EQ(read_lines(arm_path()).back().at("step"), "open");
  EXPECT_EQ(read_lines(arm_path()).back().at("pick"), 1);
}

TEST_F(RecordsTest, AnArmWithoutAFileIsNamed) {
  std::ofstream(arm_path().parent_path()) << "a file where the folder should be";
  const auto arm = RecordingArm::create(arm_path(), {});
  ASSERT_FALSE(arm);
  EXPECT_THAT(arm.error().message, HasSubstr(arm_path().string()));
}

TEST_F(RecordsTest, AFullDiskIsAFaultOfTheArm) {
  if (!std::filesystem::exists("/dev/full")) GTEST_SKIP() << "/dev/full is not there";
  const auto arm = RecordingArm::create("/dev/full", {});
  ASSERT_FALSE(arm);
  EXPECT_EQ(arm.error().code, Code::kInternal);
  EXPECT_THAT(arm.error().message, HasSubstr("is the disk full?"));
}

TEST_F(RecordsTest, APickBecomesOneLineOfJson) {
  script({agent::planned()});
  run();
  const std::string line = to_json(records.at(0));
  EXPECT_EQ(line.find('\n'), std::string::npos);
  const json pick = json::parse(line);
  EXPECT_EQ(pick.at("frame"), 0);
  EXPECT_EQ(pick.at("request_id"), "0123");
  EXPECT_EQ(pick.at("code"), "OK");
  EXPECT_EQ(pick.at("outcome"), "PLANNED");
  EXPECT_EQ(pick.at("objects"), 3);
  EXPECT_EQ(pick.at("grasp").at("pick"), 1);
  EXPECT_EQ(pick.at("grasp").at("part"), "tee");
  EXPECT_EQ(pick.at("grasp").at("opening_width_m"), 0.044);
  EXPECT_EQ(pick.at("grasp").at("grs").at("grs"), 1.0);
  EXPECT_EQ(pick.at("verdict"), "PLACED");
  EXPECT_EQ(pick.at("ms").at("plan"), 80);
  EXPECT_EQ(pick.at("ms").at("place"), 600);
  EXPECT_EQ(pick.at("ms").at("server").at("registration"), 42e-6);
  EXPECT_FALSE(pick.contains("message"));
}

TEST_F(RecordsTest, AnAlarmIsKeptWithTheFrameThatRaisedIt) {
  task.drift = {.limit_m = 0.006, .answers_n = 2};
  PlanAnswer adrift = agent::planned();
  adrift.bin_drift_m = 0.008;
  script({adrift, adrift, adrift, agent::planned()});
  run();
  std::vector<std::string> alarms;
  for (const agent::PickRecord& record : records) {
    alarms.push_back(json::parse(to_json(record)).value("alarm", ""));
  }
  EXPECT_THAT(alarms, ElementsAre("", HasSubstr("8.0 to 8.0 mm off in 2 frames"), "", ""));
}

TEST_F(RecordsTest, WhatAPickDidNotComeToIsLeftOut) {
  script({agent::refusal(Code::kUnknownPart)});
  run();
  const json pick = json::parse(to_json(records.at(0)));
  EXPECT_EQ(pick.at("code"), "UNKNOWN_PART");
  EXPECT_EQ(pick.at("message"), "no plan today");
  for (const char* key : {"outcome", "objects", "grasp", "verdict"}) {
    EXPECT_FALSE(pick.contains(key)) << key;
  }
  EXPECT_FALSE(pick.at("ms").contains("pick"));
}

TEST_F(RecordsTest, AMessageThatIsNotUtf8IsStillWritten) {
  agent::PickRecord record;
  record.message = "caf\xe9.rawlog: broken";
  EXPECT_THAT(json::parse(to_json(record)).at("message").get<std::string>(),
              HasSubstr(".rawlog: broken"));
}

}  // namespace
}  // namespace graspd::record
