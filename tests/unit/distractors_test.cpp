#include <gtest/gtest.h>

#include <ostream>
#include <string>
#include <vector>

#include "graspd/eval/evaluate.hpp"
#include "graspd/perception/planner.hpp"
#include "graspd/simulation/scene.hpp"
#include "part_test_support.hpp"

/// Bins that hold other parts than the one that is asked for: pieces of these look like it.
namespace graspd::perception {
namespace {

struct BinOfOthers {
  std::string name;
  std::vector<simulation::PartCount> parts;
  std::vector<std::string> absent;
};

void PrintTo(const BinOfOthers& bin, std::ostream* out) { *out << bin.name; }

class DistractorsTest : public testing::TestWithParam<BinOfOthers> {};

TEST_P(DistractorsTest, HardlyAnythingIsFoundThatIsNotInTheBin) {
  const auto catalogue = parts::Catalogue::load(parts::own_parts_folder());
  simulation::SceneOptions options;
  options.parts = GetParam().parts;
  options.seed = 2000;
  const auto image = simulation::SceneMaker::create(*catalogue, options)->make(0);
  const auto answer = [&](const std::string& asked) {
    return plan(image->frame, eval::request_for(*image, *catalogue, {asked}), *catalogue, {})
        .value();
  };
  std::size_t false_n = 0;
  for (const std::string& part : GetParam().absent) {
    const PlanAnswer got = answer(part);
    false_n += got.objects.size();
    for (const Object& object : got.objects) EXPECT_LT(object.score, 0.3) << part;
  }
  EXPECT_LE(false_n, 5U) << "17 among the brackets and 14 among the three, were the bin not asked";
  EXPECT_GE(answer(GetParam().parts.front().part_id).objects.size(), 3U);
}

const std::vector<BinOfOthers> kBins = {
    {"Brackets", {{"l_bracket", 30}}, {"tee", "elbow", "flanged_ring", "hex_bolt"}},
    {"Bolts", {{"hex_bolt", 30}}, {"l_bracket", "elbow", "flanged_ring", "straight_pipe"}},
    {"PipesBracketsAndBolts",
     {{"straight_pipe", 10}, {"l_bracket", 10}, {"hex_bolt", 10}},
     {"tee", "elbow", "flanged_ring"}}};
INSTANTIATE_TEST_SUITE_P(Bins, DistractorsTest, testing::ValuesIn(kBins),
                         [](const auto& test) { return test.param.name; });

}  // namespace
}  // namespace graspd::perception
