#include <gmock/gmock.h>

#include <fstream>

#include "../bench/cell_report.hpp"
#include "temporary_folder.hpp"

/// The files that a run of Table II grows by and goes on from.
namespace graspd::bench {
namespace {

using ::testing::HasSubstr;

const BinKey kKey{"verified", "tee", 3};
const PickRow kPick{1, "SUCCESS", "", 0.001, 0.25, 0.5, 0.9, 0.004};

class CellLogTest : public ::testing::Test {
 protected:
  std::string stem() const { return (folder_.path() / "cell").string(); }
  std::filesystem::path bins_path() const { return stem() + "_bins.csv"; }
  std::string bins() const {
    std::ifstream file(bins_path());
    return {std::istreambuf_iterator<char>(file), {}};
  }

 private:
  testing::TemporaryFolder folder_;
};

TEST_F(CellLogTest, ABinIsReadAgainAsItWasWritten) {
  const BinRow row{"0123abc", 30, 29, 512.5, 7.25, 60.5, 2, "stopped: a, b, c"};
  {
    CellLog log(stem(), false);
    log.add(kKey, kPick);
    log.add(kKey, row);
  }
  const CellLog again(stem(), false);
  ASSERT_TRUE(again.has(kKey));
  const BinRow& read = again.results().at(0).bin;
  EXPECT_EQ(read.commit, row.commit);
  EXPECT_EQ(read.placed_n, 29);
  EXPECT_EQ(read.wall_s, 60.5);
  EXPECT_EQ(read.resets_n, 2);
  EXPECT_EQ(read.reason, row.reason);
  EXPECT_EQ(again.results().at(0).picks.size(), 1U);
}

TEST_F(CellLogTest, RowsFromBeforeResetsWereCountedSayThatTheyAreNotKnown) {
  std::ofstream(bins_path())
      << "pipeline,part,seed,commit,parts,placed,duration_s,planning_s,wall_s,reason\n"
         "verified,tee,3,682ad9e,30,27,518.597,70.394,167.88,stirred 8 times, and still\n";
  CellLog log(stem(), false);
  ASSERT_TRUE(log.has(kKey));
  EXPECT_EQ(log.results().at(0).bin.resets_n, std::nullopt);
  EXPECT_EQ(log.results().at(0).bin.reason, "stirred 8 times, and still");
  log.add({"verified", "tee", 4}, BinRow{"", 30, 30, 1, 1, 1, 0, "BIN_EMPTY"});
  EXPECT_THAT(bins(), HasSubstr("wall_s,resets,reason\n"));
  EXPECT_THAT(bins(), HasSubstr(",167.88,,stirred 8 times, and still\n"));
  EXPECT_THAT(bins(), HasSubstr(",1.00,0,BIN_EMPTY\n"));
}

TEST_F(CellLogTest, OtherColumnsAreRefused) {
  std::ofstream(bins_path()) << "pipeline,part\n";
  EXPECT_THROW(CellLog(stem(), false), std::runtime_error);
  EXPECT_NO_THROW(CellLog(stem(), true));
}

}  // namespace
}  // namespace graspd::bench
