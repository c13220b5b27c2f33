#include "folder_watch.hpp"

#include <gmock/gmock.h>

#include "temporary_folder.hpp"

namespace graspd::console {
namespace {

using namespace std::chrono_literals;
using ::testing::Contains;
using ::testing::Not;

class FolderWatchTest : public ::testing::Test {
 protected:
  std::filesystem::path path(const std::string& name) const { return folder.path() / name; }

  testing::TemporaryFolder folder;
};

TEST_F(FolderWatchTest, SaysWhatIsThereAndWhatComes) {
  const auto old = folder.write("cell/old", "1");
  FolderWatch watch({folder.path()}, {"frames"});
  EXPECT_THAT(watch.wait(0ms), Contains(old));
  const auto in_new_folder = folder.write("other/deep/new", "2");
  std::set<std::filesystem::path> seen;
  while (!seen.contains(in_new_folder)) seen.merge(watch.wait(10s));
  const auto skipped = folder.write("frames/000000.png", "3");
  folder.write("cell/part", "4");
  std::filesystem::rename(path("cell/part"), path("cell/whole"));
  seen.clear();
  while (!seen.contains(path("cell/whole"))) seen.merge(watch.wait(10s));
  EXPECT_THAT(seen, Not(Contains(skipped)));
}

TEST_F(FolderWatchTest, WaitsForAFolderThatIsYetToCome) {
  FolderWatch watch({path("flights")}, {});
  EXPECT_TRUE(watch.wait(0ms).empty());
  const auto file = folder.write("flights/cell/one", "1");
  EXPECT_THAT(watch.wait(0ms), Contains(file));
  std::filesystem::remove_all(path("flights"));
  const auto again = folder.write("flights/cell/two", "2");
  std::set<std::filesystem::path> seen;
  while (!seen.contains(again)) seen.merge(watch.wait(1s));
}

}  // namespace
}  // namespace graspd::console
