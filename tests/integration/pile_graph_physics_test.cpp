/// The pile graph against rigid-body physics: who bears whom, and what comes along when a part is
/// lifted straight up.
#include <gmock/gmock.h>

#include <algorithm>
#include <filesystem>
#include <map>

#include "graspd/parts/part.hpp"
#include "graspd/perception/pile_graph.hpp"
#include "graspd/simulation/pile_physics.hpp"

namespace graspd {
namespace {

using ::testing::ElementsAre;

const Eigen::Vector3d kBin_m(0.22, 0.18, 0.12);
constexpr double kTakenAlong_m = 0.03;

parts::Part load(const std::string& id) {
  const auto file =
      std::filesystem::path(GRASPD_SOURCE_DIR) / "deploy" / "parts" / id / "part.yaml";
  return parts::make_part(parts::read_part_file(file).value()).value();
}

std::vector<perception::PlacedPart> placed(const std::vector<simulation::PiledPart>& pile,
                                           const std::vector<parts::Part>& kinds) {
  std::vector<perception::PlacedPart> parts;
  for (const auto& part : pile) parts.push_back({&kinds[part.kind], part.T_bin_part});
  return parts;
}

TEST(PileGraphPhysics, WhoBearsWhomInAPileOfTees) {
  const std::vector<parts::Part> kinds = {load("tee")};
  const auto pile = simulation::PileMaker({kinds[0].mesh}).drop({18}, kBin_m, 5);
  ASSERT_TRUE(pile) << pile.error().message;
  std::map<std::pair<std::size_t, std::size_t>, double> share;
  const simulation::PilePhysics physics({kinds[0].mesh});
  for (const auto& bearing : physics.bearings(pile->parts, kBin_m)) {
    share[{bearing.upper, bearing.lower}] = bearing.share;
  }
  const auto graph = perception::make_pile_graph(placed(pile->parts, kinds), {});

  int both_n = 0, said_n = 0, true_n = 0, supporting_n = 0, known_n = 0;
  for (std::uint32_t lower = 0; lower < pile->parts.size(); ++lower) {
    bool is_supporting = false;
    for (std::uint32_t upper = 0; upper < pile->parts.size(); ++upper) {
      const double there = share[{upper, lower}];
      const bool is_true = there >= 0.1 && there >= share[{lower, upper}];
      const bool is_said = std::ranges::count(graph.supports[lower], upper) > 0;
      both_n += is_true && is_said;
      said_n += is_said;
      true_n += is_true;
      is_supporting |= is_true;
    }
    supporting_n += is_supporting;
    known_n += is_supporting && !graph.supports[lower].empty();
  }
  RecordProperty("precision", std::to_string(double(both_n) / said_n));
  RecordProperty("recall", std::to_string(double(both_n) / true_n));
  EXPECT_GE(true_n, 15) << "a pile, not a layer";
  EXPECT_GE(both_n, 0.75 * true_n) << said_n << " said, " << true_n << " true";
  EXPECT_GE(both_n, 0.65 * said_n) << said_n << " said, " << true_n << " true";
  EXPECT_GE(known_n, 0.85 * supporting_n);
}

/// A ring stands on its flange's edge, and a bolt lies in its bore.
TEST(PileGraphPhysics, ABoltThroughARingIsEntangledAndEachTakesTheOtherAlong) {
  const std::vector<parts::Part> kinds = {load("flanged_ring"), load("hex_bolt")};
  const Eigen::AngleAxisd lying(-M_PI / 2, Eigen::Vector3d::UnitX());  // z becomes y
  std::vector<simulation::PiledPart> pile(3);
  pile[0] = {0, Eigen::Translation3d(0, 0, 0.028) * lying};
  pile[1] = {1, Eigen::Translation3d(0, 0.028, 0.0215) * lying};
  pile[2] = {1, Eigen::Translation3d(0.07, 0, 0.014) * lying};

  const auto graph = perception::make_pile_graph(placed(pile, kinds), {});
  EXPECT_THAT(graph.entangled_with[0], ElementsAre(1));
  EXPECT_THAT(graph.entangled_with[1], ElementsAre(0));
  EXPECT_TRUE(graph.is_free(2));

  const simulation::PilePhysics physics({kinds[0].mesh, kinds[1].mesh});
  for (const std::size_t lifted : {0U, 1U}) {
    const auto moved = physics.lift(lifted, pile, kBin_m);
    EXPECT_GT(moved[1 - lifted].rise_m, kTakenAlong_m) << "with " << lifted;
    EXPECT_LT(moved[2].rise_m, 0.005);
  }
  EXPECT_LT(physics.lift(2, pile, kBin_m)[1].rise_m, 0.005);
}

}  // namespace
}  // namespace graspd
