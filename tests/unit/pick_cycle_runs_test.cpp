#include <fstream>
#include <nlohmann/json.hpp>

#include "graspd/pick_records/runs.hpp"
#include "graspd/record/run_recorder.hpp"
#include "pick_cycle_fixture.hpp"
#include "temporary_folder.hpp"

/// The records of a run: written, and read again.
namespace graspd::record {
namespace {

using pick_records::read_runs;

using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::SizeIs;

class RunsTest : public agent::PickCycleTest {
 protected:
  /// One pick with a grasp passed over, then an empty bin; all of it recorded.
  std::filesystem::path record_run() {
    PlanAnswer answer = agent::planned();
    std::reverse(answer.grasps.begin(), answer.grasps.end());
    task.T_base_place.translation().setZero();
    robot.reach_m = 0.25;
    script({answer, agent::nothing(Outcome::kBinEmpty)});
    run();
    auto recorder = RunRecorder::create(folder.path() / "runs", "cell 7", {}, true);
    EXPECT_TRUE(recorder) << recorder.error().message;
    for (const agent::PickRecord& record : records) EXPECT_TRUE(recorder->finished(record));
    EXPECT_TRUE(recorder->ended("DONE", reason, {}));
    return recorder->folder();
  }
  std::string refusal() const {
    const auto runs = read_runs(folder.path());
    return runs ? "" : runs.error().message;
  }

  testing::TemporaryFolder folder;
};

TEST_F(RunsTest, AreReadAsTheyWereWritten) {
  const auto path = record_run();
  EXPECT_EQ(path.filename(), "cell 7_1970-01-01T00-00-00Z");
  const auto runs = read_runs(folder.path());
  ASSERT_TRUE(runs) << runs.error().message;
  ASSERT_THAT(*runs, SizeIs(1));
  const auto& kept = runs->front();
  EXPECT_EQ(kept.folder, path);
  EXPECT_EQ(kept.cell, "cell 7");
  EXPECT_EQ(kept.state, "DONE");
  EXPECT_EQ(kept.reason, "BIN_EMPTY: so it is");
  ASSERT_THAT(kept.picks, SizeIs(2));
  const pick_records::PickLine& pick = kept.picks[0];
  EXPECT_TRUE(pick.is_pick());
  EXPECT_EQ(pick.part, "elbow");
  EXPECT_EQ(pick.verdict, "PLACED");
  ASSERT_THAT(pick.passed_over, SizeIs(1));
  EXPECT_EQ(pick.passed_over[0].reason, "pre_grasp is out of reach");
  double sum_ms = 0;
  for (const auto& [step, ms] : pick.steps_ms) sum_ms += ms;
  EXPECT_NEAR(sum_ms, (pick.end_s - pick.start_s) * 1e3, 1e-6);
  EXPECT_FALSE(kept.picks[1].is_pick());
  EXPECT_EQ(kept.picks[1].outcome, "BIN_EMPTY");
}

TEST_F(RunsTest, EachHasAFolderOfItsOwn) {
  const auto first = RunRecorder::create(folder.path(), "a", {}, false);
  const auto second = RunRecorder::create(folder.path(), "a", {}, false);
  ASSERT_TRUE(first && second);
  EXPECT_EQ(second->folder().filename(), "a_1970-01-01T00-00-00Z-2");
  const auto runs = read_runs(folder.path());
  ASSERT_TRUE(runs) << runs.error().message;
  ASSERT_THAT(*runs, SizeIs(2));
  EXPECT_EQ((*runs)[0].state, "RUNNING");
  EXPECT_THAT((*runs)[0].picks, IsEmpty());
}

TEST_F(RunsTest, ALineThatWasCutOffIsLeftOut) {
  const auto picks = record_run() / "picks.jsonl";
  std::filesystem::resize_file(picks, std::filesystem::file_size(picks) - 5);
  const auto runs = read_runs(folder.path());
  ASSERT_TRUE(runs) << runs.error().message;
  EXPECT_THAT(runs->front().picks, SizeIs(1));
}

TEST_F(RunsTest, ALineThatIsNoneIsNamed) {
  const auto picks = record_run() / "picks.jsonl";
  std::ofstream(picks, std::ios::app) << "{\"frame\": 3}\n";
  EXPECT_THAT(refusal(), HasSubstr(picks.string() + ":3: no record of a pick"));
}

TEST_F(RunsTest, ARunThatSaysNothingOfItselfIsNamed) {
  const auto run_json = record_run() / "run.json";
  std::ofstream(run_json) << "nothing";
  EXPECT_THAT(refusal(), HasSubstr(run_json.string()));
}

TEST_F(RunsTest, AFolderThatCanNotBeMadeIsNamed) {
  std::ofstream(folder.path() / "file") << "a file where the folder should be";
  const auto recorder = RunRecorder::create(folder.path() / "file", "a", {}, true);
  ASSERT_FALSE(recorder);
  EXPECT_THAT(recorder.error().message, HasSubstr((folder.path() / "file").string()));
}

}  // namespace
}  // namespace graspd::record
