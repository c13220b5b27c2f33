#include "graspd/onboarding/onboarding.hpp"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <map>
#include <sstream>

#include "graspd/eval/evaluate.hpp"
#include "graspd/eval/interval.hpp"
#include "graspd/onboarding/decimate.hpp"
#include "graspd/onboarding/part_folder.hpp"
#include "graspd/parts/catalogue.hpp"
#include "part_test_support.hpp"
#include "symmetry_meshes.hpp"

namespace graspd::onboarding {
namespace {

using ::testing::HasSubstr;

/// Through a folder of parts, as the command makes it.
parts::Part part_of(const parts::Mesh& mesh) {
  const parts::TestFolder folder;
  return write_mesh(version_in(folder.path(), "it", mesh, false).value(), mesh).value();
}

double sum_of(const std::vector<StablePose>& poses) {
  double sum = 0;
  for (const StablePose& pose : poses) sum += pose.probability;
  return sum;
}

TEST(StablePoses, OfACubeAreItsSixFacesAllAlike) {
  const parts::Part cube = part_of(parts::box_mesh({0, 0, 0}, {0.04F, 0.04F, 0.04F}, 3));
  const auto poses = stable_poses(cube);
  ASSERT_EQ(poses.size(), 6U);
  for (const StablePose& pose : poses) {
    EXPECT_NEAR(pose.probability, 1.0 / 6, 1e-6);
    EXPECT_NEAR(pose.height_m, 0.02, 1e-6);
    EXPECT_NEAR(pose.tip_rad, M_PI / 4, 1e-4);
    EXPECT_NEAR(pose.down.cwiseAbs().maxCoeff(), 1, 1e-6);
  }
  EXPECT_EQ(alike(poses, cube).size(), 1U);
}

TEST(StablePoses, OfABoxAreFlatMoreOftenThanOnEnd) {
  const parts::Part box = part_of(parts::box_mesh({0, 0, 0}, {0.08F, 0.05F, 0.02F}));
  const auto poses = stable_poses(box);
  ASSERT_EQ(poses.size(), 6U);
  EXPECT_NEAR(sum_of(poses), 1, 1e-5);
  EXPECT_NEAR(std::abs(poses.front().down.z()), 1, 1e-6);
  EXPECT_NEAR(std::abs(poses.back().down.x()), 1, 1e-6);
  const auto groups = alike(poses, box);
  ASSERT_EQ(groups.size(), 3U);
  for (const auto& group : groups) EXPECT_EQ(group.size(), 2U);
}

TEST(StablePoses, OfARodAreLyingAndTwoEnds) {
  const parts::Part rod = part_of(parts::prism_mesh(48, 0.01, 0.08));
  ASSERT_EQ(rod.symmetries.continuous.size(), 1U);
  const auto poses = stable_poses(rod);
  ASSERT_EQ(poses.size(), 3U);
  EXPECT_NEAR(poses[0].down.z(), 0, 1e-6);
  EXPECT_NEAR(poses[0].height_m, 0.01, 1e-4);
  // An end's disc from the middle: half of 1 − cos of the angle that it fills.
  const double end = (1 - 0.04 / std::hypot(0.04, 0.01)) / 2;
  EXPECT_NEAR(poses[1].probability, end, 1e-3);
  EXPECT_NEAR(poses[2].probability, end, 1e-3);
  EXPECT_EQ(alike(poses, rod).size(), 2U);
}

TEST(StablePoses, OfAConeAreItsBaseAndItsSide) {
  const double radius_m = 0.02, height_m = 0.03;
  const parts::Part cone =
      part_of(parts::loft_mesh(64, parts::circle(radius_m), parts::circle(1e-5), height_m));
  const auto poses = stable_poses(cone);
  ASSERT_EQ(poses.size(), 2U);
  const double base = (1 - (height_m / 4) / std::hypot(height_m / 4, radius_m)) / 2;
  const auto standing =
      std::ranges::find_if(poses, [](const StablePose& pose) { return pose.down.z() < -0.999; });
  ASSERT_NE(standing, poses.end());
  EXPECT_NEAR(standing->probability, base, 2e-3);
  EXPECT_NEAR(standing->height_m, height_m / 4, 1e-4);
}

TEST(StablePoses, NoneIsLeftOfAFaceThatItTipsOff) {
  // A prism that leans so far that it can't stand on its end.
  parts::Mesh leaning = parts::box_mesh({0, 0, 0}, {0.02F, 0.02F, 0.06F});
  for (auto& vertex : leaning.vertices_m) vertex.x() += vertex.z();
  const parts::Part part = part_of(leaning);
  const auto poses = stable_poses(part);
  EXPECT_NEAR(sum_of(poses), 1, 1e-5);
  for (const StablePose& pose : poses) EXPECT_LT(std::abs(pose.down.z()), 0.99);
}

TEST(Decimate, KeepsTheSizeAndTheVolume) {
  const parts::Mesh fine = parts::prism_mesh(60'000, 0.03, 0.05);  // 240,000 triangles
  const Decimated coarse = decimate(fine);
  EXPECT_LE(coarse.mesh.triangles.size(), kDecimatedTriangles);
  EXPECT_LT(coarse.error_m, 1e-3 * 0.06);
  EXPECT_NEAR(parts::diameter_m(coarse.mesh), parts::diameter_m(fine), 1e-4);
  EXPECT_NEAR(parts::signed_volume_m3(coarse.mesh) / parts::signed_volume_m3(fine), 1, 1e-3);
  for (const auto& triangle : coarse.mesh.triangles) {
    for (const int index : triangle) {
      ASSERT_GE(index, 0);
      ASSERT_LT(static_cast<std::size_t>(index), coarse.mesh.vertices_m.size());
    }
  }
}

/// Round, with a hole through it, of twice cuts_n² triangles.
parts::Mesh torus_mesh(int cuts_n, double radius_m, double tube_m) {
  parts::Mesh mesh;
  for (int i = 0; i < cuts_n; ++i) {
    for (int j = 0; j < cuts_n; ++j) {
      const double u = 2 * M_PI * i / cuts_n, v = 2 * M_PI * j / cuts_n;
      const double r_m = radius_m + tube_m * std::cos(v);
      mesh.vertices_m.push_back(
          Eigen::Vector3d(r_m * std::cos(u), r_m * std::sin(u), tube_m * std::sin(v))
              .cast<float>());
      const int next_i = (i + 1) % cuts_n, next_j = (j + 1) % cuts_n;
      const int a = i * cuts_n + j, b = next_i * cuts_n + j;
      const int c = next_i * cuts_n + next_j, d = i * cuts_n + next_j;
      mesh.triangles.insert(mesh.triangles.end(), {{a, b, c}, {a, c, d}});
    }
  }
  return mesh;
}

TEST(Decimate, LeavesAClosedSurfaceClosed) {
  const Decimated coarse = decimate(torus_mesh(400, 0.03, 0.009), 4000);
  for (const parts::MeshFinding& finding : parts::check_mesh(coarse.mesh, {})) {
    if (finding.topic != "holes" && finding.topic != "triangles") continue;
    EXPECT_EQ(finding.severity, parts::Severity::kOk) << finding.topic << ": " << finding.sentence;
  }
}

TEST(Decimate, LeavesABoxItsCorners) {
  const parts::Mesh box = parts::box_mesh({0, 0, 0}, {0.06F, 0.04F, 0.02F}, 12);
  const Decimated coarse = decimate(box, 12);
  EXPECT_LE(coarse.mesh.triangles.size(), 24U);
  EXPECT_NEAR(parts::signed_volume_m3(coarse.mesh), 48e-6, 1e-9);
}

TEST(PartFolder, WritesAPartThatTheCatalogueLoads) {
  const parts::TestFolder folder;
  const parts::Mesh mesh = parts::box_mesh({0, 0, 0}, {0.06F, 0.04F, 0.02F}, 2);
  const auto version = version_in(folder.path(), "block", mesh, false);
  ASSERT_TRUE(version) << version.error().message;
  EXPECT_EQ(version->version, 1);
  EXPECT_EQ(version->bop_obj_id, 1);
  ASSERT_TRUE(write_mesh(*version, mesh));
  EXPECT_FALSE(parts::Catalogue::load(folder.path())) << "half a part is none";
  ASSERT_TRUE(write_part_file(*version, "one: line\nand \"another\""));
  const auto catalogue = parts::Catalogue::load(folder.path());
  ASSERT_TRUE(catalogue) << catalogue.error().message;
  ASSERT_NE(catalogue->find("block"), nullptr);
  EXPECT_NEAR(catalogue->find("block")->diameter_m,
              mesh.vertices_m.empty() ? 0 : parts::diameter_m(mesh), 1e-7);
}

TEST(PartFolder, RefusesAnotherVersionUntilToldAndKeepsTheOld) {
  const parts::TestFolder folder;
  const auto add = [&](const parts::Mesh& mesh, bool is_replacing) -> Result<PartVersion> {
    auto version = version_in(folder.path(), "block", mesh, is_replacing);
    if (!version) return version;
    EXPECT_TRUE(write_mesh(*version, mesh));
    EXPECT_TRUE(write_part_file(*version, "made by a test"));
    return version;
  };
  const parts::Mesh first = parts::box_mesh({0, 0, 0}, {0.06F, 0.04F, 0.02F});
  const parts::Mesh second = parts::box_mesh({0, 0, 0}, {0.06F, 0.04F, 0.03F});
  ASSERT_TRUE(add(first, false));
  EXPECT_TRUE(add(first, false)->is_there_already);

  const auto refused = add(second, false);
  ASSERT_FALSE(refused);
  EXPECT_THAT(refused.error().message, HasSubstr("version 1 of 'block' is there"));
  EXPECT_THAT(refused.error().message, HasSubstr("--replace"));

  const auto replaced = add(second, true);
  ASSERT_TRUE(replaced);
  EXPECT_EQ(replaced->version, 2);
  const auto catalogue = parts::Catalogue::load(folder.path());
  ASSERT_TRUE(catalogue) << catalogue.error().message;
  EXPECT_NEAR(catalogue->find("block")->diameter_m, parts::diameter_m(second), 1e-7);
  const auto old = parts::read_part_file(folder.path() / "block" / "part_1.yaml");
  ASSERT_TRUE(old) << old.error().message;
  EXPECT_NEAR(parts::make_part(*old)->diameter_m, parts::diameter_m(first), 1e-7);
}

TEST(PartFolder, NamesAndNumbersAreOnePartsOwn) {
  const parts::TestFolder folder;
  const parts::Mesh mesh = parts::box_mesh({0, 0, 0}, {0.06F, 0.04F, 0.02F});
  const auto first = version_in(folder.path(), "block", mesh, false);
  ASSERT_TRUE(write_mesh(*first, mesh) && write_part_file(*first, ""));
  EXPECT_EQ(version_in(folder.path(), "other", mesh, false)->bop_obj_id, 2);
  for (const char* name : {"", "a b", "../up", ".hidden", "a/b", "ä"}) {
    EXPECT_FALSE(version_in(folder.path(), name, mesh, false)) << name;
  }
  std::filesystem::rename(folder.path() / "block", folder.path() / "elsewhere");
  const auto taken = version_in(folder.path(), "block", mesh, false);
  ASSERT_FALSE(taken);
  EXPECT_THAT(taken.error().message, HasSubstr("elsewhere"));
}

ForecastOptions few_piles() {
  ForecastOptions options;
  options.piles_n = 2;
  options.parts_n = 12;
  return options;
}

/// The score that `./run bench accuracy` gives the same piles.
/// A box that jaws can take, with what the mesh's check is made to say.
Onboarding onboarding_with(std::vector<parts::MeshFinding> findings) {
  Onboarding found;
  found.part = part_of(parts::box_mesh({0, 0, 0}, {0.06F, 0.04F, 0.02F}));
  found.findings = std::move(findings);
  found.forecast.piles.resize(6);
  found.forecast.asked_n = 6;
  return found;
}

TEST(Verdict, SaysAnUnlikelySizeOnceAndNothingThatFollowsFromIt) {
  const auto small = onboarding_with({{parts::Severity::kWarning, "units", "It is too small."}});
  const Verdict verdict = verdict_of(small);
  EXPECT_EQ(verdict.fitness, Fitness::kPoor);
  EXPECT_THAT(verdict.sentence, HasSubstr("is no part for this cell. It is too small."));
  EXPECT_THAT(advice_for(small), ::testing::IsEmpty());
}

TEST(Advice, BlamesNoEdgesThatDecimationMade) {
  const auto of_edges = ::testing::Contains(HasSubstr("3 edges"));
  const parts::MeshFinding edges{parts::Severity::kWarning, "edges", "At 3 edges …"};
  EXPECT_THAT(advice_for(onboarding_with({edges})), of_edges);
  EXPECT_THAT(advice_for(onboarding_with({{parts::Severity::kOk, "decimated", ""}, edges})),
              ::testing::Not(of_edges));
}

TEST(Advice, SaysTheTimeThatAllPilesWouldTake) {
  auto cut_short = onboarding_with({});
  cut_short.forecast.asked_n = 24;
  cut_short.forecast.duration_s = 121;
  EXPECT_THAT(advice_for(cut_short), ::testing::Contains(HasSubstr("6 of 24 piles")));
  EXPECT_THAT(advice_for(cut_short), ::testing::Contains(HasSubstr("--limit-s 540")));
}

TEST(Forecast, ScoresAsTheAccuracyBenchDoes) {
  const auto tee = parts::read_part_file(parts::own_parts_folder() / "tee" / "part.yaml")
                       .and_then(parts::make_part);
  ASSERT_TRUE(tee) << tee.error().message;
  const ForecastOptions options = few_piles();
  const auto found = forecast(*tee, options);
  ASSERT_TRUE(found) << found.error().message;

  const parts::Catalogue catalogue({*tee});
  simulation::SceneOptions scene;
  scene.parts = {{"tee", options.parts_n}};
  const auto maker = simulation::SceneMaker::create(catalogue, scene);
  eval::PoseAccuracy bench;
  for (int k = 0; k < options.piles_n; ++k) {
    auto image = maker->make(k);
    image->instance.reset();
    const auto report = eval::evaluate_image(
        *image, 0, eval::request_for(*image, catalogue, {"tee"}), catalogue, {});
    bench += *report->poses;
  }
  const eval::PoseAccuracy poses = found->poses();
  ASSERT_GT(bench.found_n(), 0);
  EXPECT_EQ(poses.objects_n(), bench.objects_n());
  EXPECT_EQ(poses.found_n(), bench.found_n());
  EXPECT_EQ(poses.answers_n(), bench.answers_n());
  EXPECT_EQ(poses.average_precision(), bench.average_precision());
  EXPECT_LE(found->pickable_n(), poses.found_n());
}

TEST(Forecast, IsTheSameTwiceAndEndsWhenTheTimeIsUp) {
  const parts::Part block = part_of(parts::box_mesh({0, 0, 0}, {0.08F, 0.05F, 0.02F}));
  ForecastOptions options = few_piles();
  const auto first = forecast(block, options);
  const auto second = forecast(block, options);
  ASSERT_TRUE(first && second);
  EXPECT_EQ(first->poses().found_n(), second->poses().found_n());
  EXPECT_EQ(first->openings_m(), second->openings_m());
  EXPECT_EQ(first->pickable_n(), second->pickable_n());

  options.piles_n = 100;
  options.limit_s = 0;
  const auto one = forecast(block, options);
  ASSERT_TRUE(one);
  EXPECT_EQ(one->piles.size(), 1U);
  EXPECT_EQ(one->asked_n, 100);
  EXPECT_EQ(one->piles.front().poses.found_n(), first->piles.front().poses.found_n());
}

TEST(Forecast, RefusesABinThatThePartDoesNotLieIn) {
  const parts::Part bar = part_of(parts::box_mesh({0, 0, 0}, {0.5F, 0.03F, 0.02F}));
  const auto refused = forecast(bar, few_piles());
  ASSERT_FALSE(refused);
  EXPECT_THAT(refused.error().message, HasSubstr("does not lie flat in a bin"));
}

}  // namespace
}  // namespace graspd::onboarding
