#include <fmt/format.h>
#include <gmock/gmock.h>

#include <regex>

#include "serve_process.hpp"
#include "temporary_folder.hpp"

/// deploy/demo, as `./run demo` calls it.
namespace graspd::testing {
namespace {

using ::testing::HasSubstr;

Finished demo(const std::string& environment) {
  return run(
      fmt::format("GRASPD_REAL_DATA=/nowhere {} {}/deploy/demo", environment, GRASPD_SOURCE_DIR));
}

TEST(DemoTest, ServesFourCellsAndSaysWhereThePicturesAre) {
  const TemporaryFolder folder;
  const Finished finished =
      demo(fmt::format("CELLS=2 PILE=3 OUT={} BIN={}", folder.path().string(), PROGRAMS));
  ASSERT_EQ(finished.exit_code, 0) << finished.output;
  for (const std::string cell : {"simulated_tees", "simulated_tees_2"}) {
    EXPECT_THAT(finished.output, ::testing::ContainsRegex(fmt::format("\n{} +0  PLANNED", cell)));
    EXPECT_THAT(finished.output,
                ::testing::ContainsRegex(fmt::format("{0}_2[^ ]+ +{0} +[0-9]", cell)))
        << "its summary";
  }
  for (const char* film : {"simulated_tees.gif", "simulated_tees_2/simulated_tees.gif"}) {
    EXPECT_TRUE(std::filesystem::exists(folder.path() / film));
    const auto strip = std::filesystem::path(film).replace_extension(".png");
    EXPECT_TRUE(std::filesystem::exists(folder.path() / strip));
    EXPECT_THAT(finished.output, HasSubstr(std::string("\n") + film + "  an arm"));
  }
  EXPECT_THAT(finished.output,
              HasSubstr(fmt::format("console --flights {0}/flights --records {0}/records",
                                    folder.path().string())));
  for (const std::string cell : {"tees", "elbows"}) {
    EXPECT_TRUE(std::filesystem::exists(folder.path() / "flights" / cell));
    const std::regex frame_line("\n" + cell + R"( +\d+  [A-Z_]+ )");
    const std::sregex_iterator lines(finished.output.begin(), finished.output.end(), frame_line);
    EXPECT_EQ(std::distance(lines, {}), 4) << cell << ":\n" << finished.output;
    const auto picture = folder.path() / "overlays" / cell / "000000.png";
    EXPECT_TRUE(std::filesystem::exists(picture));
    EXPECT_THAT(finished.output, HasSubstr(picture.string()));
    EXPECT_THAT(finished.output, HasSubstr("Cell " + cell + ", frame 0: ranked grasps"));
  }
  EXPECT_THAT(finished.output,
              ::testing::ContainsRegex("metrics at http://127.0.0.1:[0-9]+/metrics"));
  EXPECT_THAT(finished.output, ::testing::ContainsRegex("stage +runs +mean ms"));
  for (const std::string recording : {"kinect_tees", "realsense_elbows"}) {
    EXPECT_THAT(finished.output, HasSubstr("Left out: /nowhere/" + recording));
  }
}

TEST(DemoTest, SaysWhatToDoWhereTheProgramsAreMissing) {
  const TemporaryFolder folder;
  const Finished finished = demo(fmt::format("OUT={0} BIN={0}", folder.path().string()));
  EXPECT_EQ(finished.exit_code, 1);
  EXPECT_THAT(finished.output, HasSubstr("./run build"));
}

TEST(DemoTest, RefusesANumberOfCellsThatIsNone) {
  const Finished finished = demo("CELLS=many");
  EXPECT_EQ(finished.exit_code, 1);
  EXPECT_THAT(finished.output, HasSubstr("CELLS is 'many'"));
}

}  // namespace
}  // namespace graspd::testing
