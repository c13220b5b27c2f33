#include <gmock/gmock.h>

#include <regex>
#include <sstream>

#include "graspd/parts/catalogue.hpp"
#include "serve_process.hpp"
#include "temporary_folder.hpp"

// `grasp_server part new`, as somebody with a mesh of their own uses it.
namespace graspd::testing {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

std::string content_of(const std::filesystem::path& path) {
  std::ostringstream text;
  text << std::ifstream(path).rdbuf();
  return text.str();
}

class PartNewTest : public ::testing::Test {
 protected:
  Finished part_new(const std::string& arguments) const {
    return run(std::string(GRASP_SERVER) + " part new " + arguments + " --out " + parts().string());
  }
  std::filesystem::path parts() const { return folder_.path() / "parts"; }

  static std::string shipped(const std::string& id) {
    return std::string(GRASPD_SOURCE_DIR) + "/deploy/parts/" + id + "/" + id + ".stl";
  }

  TemporaryFolder folder_;
};

/// ASCII STL of triangles that all lie in the plane z = 0.
std::string drawing() {
  std::string stl = "solid drawing\n";
  for (int i = 0; i < 8; ++i) {
    stl += fmt::format(
        "facet normal 0 0 1\nouter loop\nvertex {} 0 0\nvertex {} 0 0\nvertex {} 40 0\nendloop\n"
        "endfacet\n",
        10 * i, 10 * i + 10, 10 * i + 10);
  }
  return stl + "endsolid drawing\n";
}

TEST_F(PartNewTest, MakesAPartThatTheServerServesAndAReportOfItsOwn) {
  const std::string arguments = shipped("tee") + " --name mine --unit mm --piles 2";
  const Finished made = part_new(arguments);
  ASSERT_EQ(made.exit_code, 0) << made.output;
  EXPECT_THAT(made.output,
              AllOf(HasSubstr("62.0 × 48.0 × 34.0 mm"), HasSubstr("stable poses"),
                    HasSubstr("pick points  24 for jaws"), HasSubstr("Parts found (recall)"),
                    HasSubstr("SIGHUP"), Not(HasSubstr("\r"))));
  const auto catalogue = parts::Catalogue::load(parts());
  ASSERT_TRUE(catalogue) << catalogue.error().message;
  ASSERT_NE(catalogue->find("mine"), nullptr);

  const std::string report = content_of(parts() / "mine" / "report.html");
  EXPECT_THAT(report, AllOf(HasSubstr("<!DOCTYPE html>"), HasSubstr("prefers-color-scheme: dark"),
                            HasSubstr("@media print"), HasSubstr("data:image/png;base64,")));
  // No other host, file or script is asked for anything.
  EXPECT_FALSE(std::regex_search(report, std::regex("https?:|<script|<link|@import|url\\(")));
  const std::regex source("src=\"(?!data:)");
  EXPECT_FALSE(std::regex_search(report, source));

  ServeProcess server({"--parts", parts().string(), "--workers", "1"});
  EXPECT_TRUE(server.wait_ready());

  const Finished again = part_new(shipped("elbow") + " --name mine --unit mm --piles 1");
  EXPECT_EQ(again.exit_code, 2) << again.output;
  EXPECT_THAT(again.output,
              AllOf(HasSubstr("version 1 of 'mine' is there"), HasSubstr("--replace")));
}

TEST_F(PartNewTest, RefusesADrawing) {
  const auto file = folder_.write("drawing.stl", drawing());
  const Finished refused = part_new(file.string() + " --name flat");
  EXPECT_EQ(refused.exit_code, 1) << refused.output;
  EXPECT_THAT(refused.output, HasSubstr("a drawing rather than a solid"));
  EXPECT_FALSE(std::filesystem::exists(parts() / "flat"));
}

TEST_F(PartNewTest, TellsOfAPartThatTheCameraCantResolveAtWhichDistanceItCould) {
  const Finished small =
      part_new(shipped("hex_bolt") + " --name bolt --unit mm --piles 1 --distance-m 1.6");
  EXPECT_EQ(small.exit_code, 0) << small.output;
  EXPECT_THAT(small.output, AllOf(HasSubstr("This camera can't resolve bolt here."),
                                  HasSubstr("bring the camera to")));
}

TEST_F(PartNewTest, SaysWhatIsWrongWithWhatItWasGiven) {
  EXPECT_EQ(part_new("nothing.stl --name it").exit_code, 2);
  const Finished near = part_new(shipped("tee") + " --name it --distance-m 0.3");
  EXPECT_EQ(near.exit_code, 2);
  EXPECT_THAT(near.output, HasSubstr("the sensor sees from 0.5 m on"));
  EXPECT_FALSE(std::filesystem::exists(parts() / "it"));
}

}  // namespace
}  // namespace graspd::testing
