#include "graspd/parts/catalogue.hpp"

#include <gmock/gmock.h>

#include <functional>
#include <set>

#include "part_test_support.hpp"

namespace graspd::parts {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::MatchesRegex;

Part part_called(const std::string& id, int bop_obj_id) {
  Part part;
  part.id = id;
  part.name = id;
  part.bop_obj_id = bop_obj_id;
  part.mesh = box_mesh({0, 0, 0}, {0.06F, 0.04F, 0.02F});
  part.symmetries.discrete.emplace_back(Eigen::AngleAxisd(3.14159, Eigen::Vector3d::UnitZ()));
  part.symmetries.continuous.emplace_back();
  part.pick_points.emplace_back();
  return part;
}

std::string yaml_of(const std::string& id, int bop_obj_id) {
  return fmt::format("id: {}\nbop_obj_id: {}\nmesh: mesh.stl\nmesh_unit: mm\n", id, bop_obj_id);
}

std::string box_stl() { return to_stl(box_mesh({0, 0, 0}, {0.06F, 0.04F, 0.02F}), 1e3); }

TEST(Catalogue, FindsPartsByIdAndByBopNumber) {
  const Catalogue catalogue({part_called("a", 3), part_called("b", 0), part_called("c", 0)});
  EXPECT_EQ(catalogue.find("b"), &catalogue.parts()[1]);
  EXPECT_EQ(catalogue.find("d"), nullptr);
  EXPECT_EQ(catalogue.find_bop(3), &catalogue.parts()[0]);
  EXPECT_EQ(catalogue.find_bop(4), nullptr);
  EXPECT_EQ(catalogue.find_bop(0), nullptr);  // no number, not a number
}

TEST(Catalogue, RefusesTwoPartsWithOneIdOrOneBopNumber) {
  EXPECT_THROW(Catalogue({part_called("a", 1), part_called("a", 2)}), std::invalid_argument);
  EXPECT_THROW(Catalogue({part_called("a", 1), part_called("b", 1)}), std::invalid_argument);
}

TEST(CatalogueHash, ChangesWithEverythingThatCanChangeAnAnswerAndWithNothingElse) {
  const auto hash_after = [](const std::function<void(Part&)>& change) {
    Part part = part_called("a", 1);
    change(part);
    return Catalogue({part, part_called("b", 2)}).hash();
  };
  const std::string hash = hash_after([](Part&) {});
  EXPECT_THAT(hash, MatchesRegex("[0-9a-f]{16}"));
  EXPECT_EQ(hash_after([](Part& p) { p.name = "another"; }), hash);
  EXPECT_EQ(hash_after([](Part& p) { p.color_rgb = {1, 2, 3}; }), hash);

  const std::vector<std::function<void(Part&)>> changes{
      [](Part& p) { p.id = "c"; },
      [](Part& p) { p.bop_obj_id = 9; },
      [](Part& p) { p.mesh.vertices_m[3].y() += 1e-6F; },
      [](Part& p) { std::swap(p.mesh.triangles[0], p.mesh.triangles[1]); },
      [](Part& p) { p.mesh.triangles.pop_back(); },
      [](Part& p) { p.symmetries.discrete.clear(); },
      [](Part& p) { p.symmetries.discrete[0].translation().x() = 1e-6; },
      [](Part& p) { p.symmetries.continuous[0].axis = Eigen::Vector3d::UnitX(); },
      [](Part& p) { p.symmetries.continuous[0].point_m.x() = 1e-6; },
      [](Part& p) { p.pick_points.clear(); },
      [](Part& p) { p.pick_points[0].name = "grip"; },
      [](Part& p) { p.pick_points[0].gripper = "grip"; },
      [](Part& p) { p.pick_points[0].position_m.z() = 1e-6; },
      [](Part& p) { p.pick_points[0].approach = Eigen::Vector3d::UnitY(); },
      [](Part& p) { p.pick_points[0].closing = Eigen::Vector3d::UnitY(); },
      [](Part& p) { p.pick_points[0].approach_cone_rad = 0.6; },
      [](Part& p) { p.pick_points[0].width_m = 0.01; },
      [](Part& p) { p.pick_points[0].tip_reach_m = 0.01; },
      [](Part& p) { p.pick_points[0].is_proposed = true; },
      [](Part& p) { p.pick_points[0].priority = 1; }};
  std::set<std::string> hashes{hash};
  for (const auto& change : changes) hashes.insert(hash_after(change));
  EXPECT_EQ(hashes.size(), changes.size() + 1);
}

TEST(CatalogueLoad, SameContentHasTheSameHashWhereverItLies) {
  const TestFolder folder;
  for (const char* root : {"here", "elsewhere"}) {
    folder.write(fmt::format("{}/a/part.yaml", root), yaml_of("a", 1));
    folder.write(fmt::format("{}/a/mesh.stl", root), box_stl());
    folder.write(fmt::format("{}/README.md", root), "no part");
    folder.write(fmt::format("{}/tools/run.sh", root), "no part either");
  }
  const auto here = Catalogue::load(folder.path() / "here");
  const auto elsewhere = Catalogue::load(folder.path() / "elsewhere");
  ASSERT_TRUE(here) << here.error().message;
  ASSERT_TRUE(elsewhere) << elsewhere.error().message;
  EXPECT_EQ(here->hash(), elsewhere->hash());
  EXPECT_EQ(here->parts().size(), 1U);
}

TEST(CatalogueLoad, TakesPartsInTheOrderOfTheirFolders) {
  const TestFolder folder;
  for (const char* id : {"m", "z", "b"}) {
    folder.write(fmt::format("{}/part.yaml", id), yaml_of(id, 0));
    folder.write(fmt::format("{}/mesh.stl", id), box_stl());
  }
  const auto catalogue = Catalogue::load(folder.path());
  ASSERT_TRUE(catalogue) << catalogue.error().message;
  std::vector<std::string> ids;
  for (const Part& part : catalogue->parts()) ids.push_back(part.id);
  EXPECT_THAT(ids, ElementsAre("b", "m", "z"));
}

TEST(CatalogueLoad, NamesEveryFileThatIsWrong) {
  const TestFolder folder;
  folder.write("good/part.yaml", yaml_of("good", 1));
  folder.write("good/mesh.stl", box_stl());
  folder.write("typo/part.yaml", yaml_of("typo", 2) + "colour: red\n");
  folder.write("meshless/part.yaml", yaml_of("meshless", 3));
  const auto catalogue = Catalogue::load(folder.path());
  ASSERT_FALSE(catalogue);
  EXPECT_EQ(catalogue.error().code, Code::kInvalidArgument);
  EXPECT_THAT(catalogue.error().message, HasSubstr("typo/part.yaml:5: unknown key 'colour'"));
  EXPECT_THAT(catalogue.error().message, HasSubstr("meshless/mesh.stl: there is no such file"));
}

TEST(CatalogueLoad, SaysWhatIsWrongWithAFolder) {
  const TestFolder folder;
  const auto empty = Catalogue::load(folder.path());
  ASSERT_FALSE(empty);
  EXPECT_THAT(empty.error().message, HasSubstr("no folder in it holds a part.yaml"));
  const auto missing = Catalogue::load(folder.path() / "none");
  ASSERT_FALSE(missing);
  EXPECT_THAT(missing.error().message, HasSubstr("none: the folder can't be read"));

  for (const char* name : {"x", "y"}) {
    folder.write(fmt::format("{}/part.yaml", name), yaml_of("twin", 0));
    folder.write(fmt::format("{}/mesh.stl", name), box_stl());
  }
  const auto twins = Catalogue::load(folder.path());
  ASSERT_FALSE(twins);
  EXPECT_THAT(twins.error().message, HasSubstr("two parts have the id 'twin'"));
}

}  // namespace
}  // namespace graspd::parts
