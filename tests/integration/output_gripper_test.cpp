#include "graspd/output_gripper/output_gripper.hpp"

#include <gmock/gmock.h>

#include <cmath>
#include <fstream>

#include "fake_clock.hpp"
#include "temporary_folder.hpp"

namespace graspd::output_gripper {
namespace {

using namespace std::chrono_literals;
using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

class OutputGripperTest : public ::testing::Test {
 protected:
  OutputGripperTest() {
    options.open = shell("echo open >> " + line().string());
    options.close = shell("echo close >> " + line().string());
  }
  static Command shell(const std::string& script) { return {"/bin/sh", "-c", script}; }
  std::filesystem::path line() const { return folder.path() / "line"; }
  std::string set() const {
    std::ifstream file(line());
    return {std::istreambuf_iterator<char>(file), {}};
  }
  std::unique_ptr<agent::Gripper> make() { return make_gripper(options, clock).value(); }
  std::string fault_of_close() {
    const auto closed = make()->close();
    EXPECT_FALSE(closed);
    if (closed) return "";
    EXPECT_EQ(closed.error().code, Code::kUnavailable);
    return closed.error().message;
  }

  testing::TemporaryFolder folder;
  agent::fakes::FakeClock clock;
  GripperOptions options;
};

TEST_F(OutputGripperTest, SetsTheLineAndGivesTheFingersTheirTime) {
  const auto gripper = make();
  ASSERT_TRUE(gripper->open(0.05));
  ASSERT_TRUE(gripper->close());
  EXPECT_EQ(set(), "open\nclose\n");
  EXPECT_THAT(clock.sleeps, ElementsAre(options.settle, options.settle));
}

TEST_F(OutputGripperTest, TellsTheWidthToWhoAsks) {
  options.open = shell("echo '{width_mm} mm' > " + line().string());
  ASSERT_TRUE(make()->open(0.0425));
  EXPECT_EQ(set(), "42.5 mm\n");
}

TEST_F(OutputGripperTest, AWidthBeyondItsStrokeIsRefusedBeforeAnythingMoves) {
  for (const double width_m : {-0.01, 0.081, std::nan("")}) {
    const auto opened = make()->open(width_m);
    ASSERT_FALSE(opened);
    EXPECT_EQ(opened.error().code, Code::kInvalidArgument);
  }
  EXPECT_EQ(set(), "");
}

TEST_F(OutputGripperTest, WithoutASensorWhatWasClosedCountsAsHeld) {
  const auto gripper = make();
  EXPECT_FALSE(gripper->holds_something().value());
  ASSERT_TRUE(gripper->close());
  EXPECT_TRUE(gripper->holds_something().value());
}

TEST_F(OutputGripperTest, TheSensorSaysWhetherSomethingIsHeld) {
  options.sensor = shell("test -e " + (folder.path() / "part").string());
  const auto gripper = make();
  ASSERT_TRUE(gripper->close());
  EXPECT_FALSE(gripper->holds_something().value());
  folder.write("part", "");
  EXPECT_TRUE(gripper->holds_something().value());
  ASSERT_TRUE(gripper->open(0.05));
  EXPECT_FALSE(gripper->holds_something().value());
}

TEST_F(OutputGripperTest, ASensorThatFailsIsNoEmptyGripper) {
  options.sensor = shell("echo no device >&2; exit 3");
  const auto held = make()->holds_something();
  ASSERT_FALSE(held);
  EXPECT_THAT(held.error().message, AllOf(HasSubstr("ended with 3"), HasSubstr("no device")));
}

TEST_F(OutputGripperTest, ACommandThatFailsIsSaidWithItsLastLine) {
  options.close = shell("echo first >&2; echo line 7 is stuck >&2; exit 4");
  EXPECT_THAT(fault_of_close(), AllOf(HasSubstr("did not confirm to close"),
                                      HasSubstr("ended with 4: line 7 is stuck")));
}

TEST_F(OutputGripperTest, ACommandThatDoesNotEndIsKilled) {
  options.timeout = 100ms;
  options.close = {"sleep", "60"};
  const auto before = std::chrono::steady_clock::now();
  EXPECT_THAT(fault_of_close(), HasSubstr("did not end within 0.1 s"));
  EXPECT_LT(std::chrono::steady_clock::now() - before, 30s);
}

TEST_F(OutputGripperTest, ACommandThatIsKilledOrNotThereIsSaid) {
  options.close = shell("kill -9 $$");
  EXPECT_THAT(fault_of_close(), HasSubstr("signal 9"));
  options.close = {"/no/such/program"};
  EXPECT_THAT(fault_of_close(), AllOf(HasSubstr("/no/such/program"), HasSubstr("can't be run")));
}

TEST_F(OutputGripperTest, WordsAreNoShell) {
  options.open = {"touch", (folder.path() / "a; b").string()};
  ASSERT_TRUE(make()->open(0.05));
  EXPECT_TRUE(std::filesystem::exists(folder.path() / "a; b"));
}

TEST_F(OutputGripperTest, AGripperWithoutCommandsIsNone) {
  options.close.clear();
  const auto gripper = make_gripper(options, clock);
  ASSERT_FALSE(gripper);
  EXPECT_THAT(gripper.error().message, HasSubstr("no command to close"));
}

}  // namespace
}  // namespace graspd::output_gripper
