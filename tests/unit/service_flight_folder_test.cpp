#include <gmock/gmock.h>
#include <sys/stat.h>

#include <fstream>
#include <set>
#include <thread>

#include "flight_folder.hpp"
#include "flight_recorder.hpp"
#include "temporary_folder.hpp"

namespace graspd::service {
namespace {

namespace fs = std::filesystem;
using graspd::testing::TemporaryFolder;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

class FlightFolderTest : public ::testing::Test {
 protected:
  static std::string name(int i) { return fmt::format("{:03}.flight", i); }
  /// Relative to the folder, but for the lock.
  std::set<std::string> files() const {
    std::set<std::string> files;
    if (!fs::exists(folder_)) return files;
    for (const auto& entry : fs::recursive_directory_iterator(folder_)) {
      const std::string file = entry.path().lexically_relative(folder_).string();
      if (entry.is_regular_file() && file != ".lock") files.insert(file);
    }
    return files;
  }

  TemporaryFolder temporary_;
  fs::path folder_ = temporary_.path() / "deep" / "flights";
};

TEST_F(FlightFolderTest, TheOldestOfACellGoesFirst) {
  FlightFolder folder(folder_, {2, 1000});
  for (int i = 0; i < 5; ++i) {
    ASSERT_TRUE(folder.add("a", name(i), "x"));
    ASSERT_TRUE(folder.add("b", name(i), "x"));
    EXPECT_LE(files().size(), 4u);
  }
  EXPECT_THAT(files(), ElementsAre("a/003.flight", "a/004.flight", "b/003.flight", "b/004.flight"));
}

TEST_F(FlightFolderTest, AboveItsBytesTheOldestOfAllGoesFirst) {
  FlightFolder folder(folder_, {100, 30});
  ASSERT_TRUE(folder.add("a", name(1), std::string(10, 'x')));
  ASSERT_TRUE(folder.add("b", name(2), std::string(10, 'x')));
  ASSERT_TRUE(folder.add("a", name(3), std::string(10, 'x')));
  ASSERT_TRUE(folder.add("c", name(4), std::string(11, 'x')));
  EXPECT_THAT(files(), ElementsAre("a/003.flight", "c/004.flight"));
  EXPECT_FALSE(fs::exists(folder_ / "b")) << "no empty folders stay";
  const auto too_large = folder.add("a", name(5), std::string(31, 'x'));
  ASSERT_FALSE(too_large);
  EXPECT_THAT(too_large.error().message, HasSubstr("larger than the whole folder"));
  EXPECT_EQ(files().size(), 2u) << "what can't be kept costs nothing else";
}

TEST_F(FlightFolderTest, WhatAnEarlierServerLeftCounts) {
  {
    FlightFolder folder(folder_, {3, 1000});
    for (int i = 0; i < 3; ++i) ASSERT_TRUE(folder.add("a", name(i), "x"));
  }
  std::ofstream(folder_ / "a" / "003.flight.part") << "it was killed while it wrote this";
  FlightFolder folder(folder_, {3, 1000});
  ASSERT_TRUE(folder.add("a", name(4), "x"));
  EXPECT_THAT(files(), ElementsAre("a/001.flight", "a/002.flight", "a/004.flight"));
}

TEST_F(FlightFolderTest, WhatSomebodyTookAwayIsNotMissed) {
  FlightFolder folder(folder_, {2, 1000});
  ASSERT_TRUE(folder.add("a", name(1), "x"));
  fs::remove_all(folder_ / "a");
  for (int i = 2; i < 5; ++i) ASSERT_TRUE(folder.add("a", name(i), "x"));
  EXPECT_THAT(files(), ElementsAre("a/003.flight", "a/004.flight"));
}

TEST_F(FlightFolderTest, NamesOfCellsStayInTheFolder) {
  FlightFolder folder(folder_, {100, 1'000'000});
  const std::vector<std::string> cells{"..",
                                       ".",
                                       "",
                                       "/etc",
                                       "a/../../b",
                                       "Zelle Süd",
                                       "%",
                                       std::string(128, '/'),
                                       std::string(127, '/') + "x",
                                       "a"};
  std::set<fs::path> paths;
  for (const std::string& cell : cells) {
    ASSERT_TRUE(folder.add(cell, name(1), "x")) << cell;
    paths.insert(folder.path_of(cell, name(1)));
  }
  EXPECT_EQ(paths.size(), cells.size());
  EXPECT_EQ(files().size(), cells.size());
  for (const auto& entry : fs::directory_iterator(temporary_.path() / "deep")) {
    EXPECT_EQ(entry.path(), folder_);
  }
}

TEST_F(FlightFolderTest, IsItsUsersAlone) {
  FlightFolder folder(folder_, {2, 1000});
  ASSERT_TRUE(folder.add("a", name(1), "x"));
  EXPECT_EQ(fs::status(folder_).permissions(), fs::perms::owner_all);
  EXPECT_EQ(fs::status(folder_ / "a" / name(1)).permissions(),
            fs::perms::owner_read | fs::perms::owner_write);
}

TEST_F(FlightFolderTest, ASecondServerWaitsUntilTheFirstHasEnded) {
  auto first = std::make_unique<FlightFolder>(folder_, FlightLimits{2, 1000});
  ASSERT_TRUE(first->add("a", name(1), "x"));
  FlightFolder second(folder_, {2, 1000});
  const auto refused = second.add("a", name(2), "x");
  ASSERT_FALSE(refused);
  EXPECT_THAT(refused.error().message, HasSubstr("another server records into this folder"));
  first.reset();
  EXPECT_TRUE(second.add("a", name(3), "x"));
}

TEST_F(FlightFolderTest, WhereNothingCanBeWrittenItSaysWhy) {
  temporary_.write("deep", "in the way");
  FlightFolder folder(folder_, {2, 1000});
  const auto refused = folder.add("a", name(1), "x");
  ASSERT_FALSE(refused);
  EXPECT_THAT(refused.error().message, HasSubstr("001.flight could not be kept: Not a directory"));
}

TEST_F(FlightFolderTest, OfAFileForWhichThereIsNoRoomNothingIsLeft) {
  FlightFolder folder(folder_, {2, 1 << 20});
  ASSERT_TRUE(folder.add("a", name(1), "x"));
  // /dev/full in the place of the file that is to be written: every write to it fails.
  fs::create_symlink("/dev/full", folder_ / "a" / (name(2) + ".part"));
  const auto refused = folder.add("a", name(2), "x");
  ASSERT_FALSE(refused);
  EXPECT_THAT(refused.error().message, HasSubstr("No space left on device"));
  EXPECT_THAT(files(), ElementsAre("a/001.flight"));
  EXPECT_TRUE(folder.add("a", name(2), "x")) << "once there is room, it goes on";
}

TEST_F(FlightFolderTest, NobodyWaitsForADiskThatStandsStill) {
  FlightRecorderConfig config;
  config.folder = folder_;
  std::vector<std::string> news;
  int kept_n = 1;
  {
    FlightRecorder recorder(config);
    recorder.keep(name(0), {"a", {}, {}, {}, {}, {}});
    while (!fs::exists(folder_ / "a" / name(0))) std::this_thread::yield();
    // A pipe in the place of the next file: its writer waits until somebody reads.
    const fs::path pipe = folder_ / "a" / (name(1) + ".part");
    ASSERT_EQ(mkfifo(pipe.c_str(), 0600), 0);
    for (; news.empty() && kept_n < 1000; ++kept_n) {
      recorder.keep(name(kept_n), {"a", {}, {}, {}, {}, {}});
      news = recorder.news();
    }
    std::ifstream(pipe).get();
  }
  ASSERT_EQ(news.size(), 1u);
  EXPECT_THAT(news[0], HasSubstr("the disk is slower than the requests"));
  EXPECT_LE(kept_n, 40);
  EXPECT_GE(files().size(), 32u) << "those that waited are written";
}

}  // namespace
}  // namespace graspd::service
