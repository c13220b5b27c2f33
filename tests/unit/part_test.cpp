#include "graspd/parts/part.hpp"

#include <gmock/gmock.h>

#include <numbers>

#include "part_test_support.hpp"

namespace graspd::parts {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::SizeIs;

using std::numbers::pi;

PartDescription box_description(const TestFolder& folder, const Mesh& mesh) {
  PartDescription description;
  description.id = "box";
  description.mesh_file = folder.write("box.stl", to_stl(mesh, 1e3));
  return description;
}

std::string fault_of(const TestFolder& folder, const std::string& yaml) {
  const auto part = read_part_file(folder.write("part.yaml", yaml));
  EXPECT_FALSE(part) << yaml;
  return part ? "" : part.error().message;
}

// --- make_part --------------------------------------------------------------------------------

TEST(MakePart, DerivesWhatItSaysFromTheMesh) {
  const TestFolder folder;
  const auto part = make_part(box_description(folder, box_mesh({0, 0, 0}, {0.02F, 0.06F, 0.03F})));
  ASSERT_TRUE(part) << part.error().message;
  EXPECT_NEAR(part->diameter_m, 0.07, 1e-7);
  EXPECT_NEAR(part->surface_area_m2, 7.2e-3, 1e-8);
  EXPECT_TRUE(part->barycentre_m.isApprox(Eigen::Vector3d(0.01, 0.03, 0.015), 1e-5));
  EXPECT_NEAR(std::abs(part->principal_axes(1, 0)), 1, 1e-5);  // y is the longest
  EXPECT_NEAR(std::abs(part->principal_axes(2, 1)), 1, 1e-5);
  EXPECT_NEAR(std::abs(part->principal_axes(0, 2)), 1, 1e-5);
  EXPECT_NEAR(static_cast<double>(part->surface.size()), 7.2e-3 / 4e-6, 0.15 * 1800);
}

TEST(MakePart, FindsTheSymmetriesUnlessTheyAreStated) {
  const TestFolder folder;
  auto description = box_description(folder, box_mesh({0, 0, 0}, {0.02F, 0.06F, 0.03F}));
  EXPECT_THAT(make_part(description)->symmetries.discrete, SizeIs(3));
  description.symmetries.emplace();
  EXPECT_THAT(make_part(description)->symmetries.discrete, SizeIs(0));
  description.symmetries->continuous.emplace_back();
  EXPECT_THAT(make_part(description)->symmetries.continuous, SizeIs(1));
}

TEST(MakePart, PrincipalAxesTurnWithThePartAndStayRightHanded) {
  const TestFolder folder;
  const Mesh box = box_mesh({-0.01F, -0.03F, -0.02F}, {0.02F, 0.06F, 0.04F}, 2);
  for (int i = 1; i < 8; ++i) {
    const Eigen::AngleAxisd turn(0.7 * i, Eigen::Vector3d(1, i, 3 - i).normalized());
    const Eigen::Isometry3d T(turn);
    const auto part = make_part(box_description(folder, moved(box, T)));
    ASSERT_TRUE(part) << part.error().message;
    EXPECT_NEAR(part->principal_axes.determinant(), 1, 1e-9);
    const Eigen::Matrix3d in_box = T.linear().transpose() * part->principal_axes;
    EXPECT_NEAR(std::abs(in_box(1, 0)), 1, 1e-4);
    EXPECT_NEAR(std::abs(in_box(2, 1)), 1, 1e-4);
    EXPECT_NEAR(std::abs(in_box(0, 2)), 1, 1e-4);
  }
}

TEST(MakePart, TurnsAnInsideOutMeshOver) {
  const TestFolder folder;
  Mesh box = box_mesh({-0.01F, -0.03F, -0.02F}, {0.02F, 0.06F, 0.04F});
  for (auto& triangle : box.triangles) std::swap(triangle[0], triangle[1]);
  const auto part = make_part(box_description(folder, box));
  ASSERT_TRUE(part);
  EXPECT_GT(signed_volume_m3(part->mesh), 0);
  for (const auto& point : part->surface) EXPECT_GT(point.normal.dot(point.position_m), 0);
}

TEST(MakePart, TurnsOverWhatIsWoundAgainstTheRest) {
  const TestFolder folder;
  const Mesh box = box_mesh({-0.01F, -0.03F, -0.02F}, {0.02F, 0.06F, 0.04F}, 3);
  const auto expect_outwards = [&](const Mesh& mesh) {
    const auto part = make_part(box_description(folder, mesh));
    ASSERT_TRUE(part);
    for (const auto& point : part->surface) EXPECT_GT(point.normal.dot(point.position_m), 0);
  };
  Mesh few = box;
  for (std::size_t i = 0; i < few.triangles.size(); i += 5) {
    std::swap(few.triangles[i][0], few.triangles[i][1]);
  }
  expect_outwards(few);
  Mesh most = box;
  for (std::size_t i = 0; i < most.triangles.size(); ++i) {
    if (i % 5 != 0) std::swap(most.triangles[i][0], most.triangles[i][1]);
  }
  expect_outwards(most);
  Mesh open = most;
  open.triangles.resize(open.triangles.size() - 2);
  expect_outwards(open);
}

TEST(MakePart, LeavesAFlatSheetAsItIs) {
  const TestFolder folder;
  Mesh sheet;
  sheet.vertices_m = {{0.1F, 0.2F, 0.3F}, {0.15F, 0.21F, 0.33F}, {0.12F, 0.26F, 0.37F}};
  sheet.triangles = {{0, 1, 2}};
  const auto normal_of = [&] {
    const auto part = make_part(box_description(folder, sheet));
    return part->surface.front().normal;
  };
  const Eigen::Vector3f normal = normal_of();
  std::swap(sheet.triangles[0][1], sheet.triangles[0][2]);
  EXPECT_LT(normal_of().dot(normal), -0.99F);
}

TEST(MakePart, NamesTheUnitThatWasProbablyMeant) {
  const TestFolder folder;
  auto description = box_description(folder, box_mesh({0, 0, 0}, {0.02F, 0.06F, 0.03F}));
  description.mesh_unit = LengthUnit::kMetre;
  const auto too_large = make_part(description);
  ASSERT_FALSE(too_large);
  EXPECT_EQ(too_large.error().code, Code::kInvalidArgument);
  EXPECT_THAT(too_large.error().message, HasSubstr("part 'box': with mesh_unit 'm'"));
  EXPECT_THAT(
      too_large.error().message,
      HasSubstr("is 7e+04 mm across, and its unit is probably mm (then it is 70 mm across)"));

  description = box_description(folder, box_mesh({0, 0, 0}, {2e-5F, 6e-5F, 3e-5F}));
  const auto too_small = make_part(description);
  ASSERT_FALSE(too_small);
  EXPECT_THAT(too_small.error().message,
              HasSubstr("is 0.07 mm across, and its unit is probably m (then it is 70 mm across)"));

  description = box_description(folder, box_mesh({0, 0, 0}, {2e-9F, 6e-9F, 3e-9F}));
  const auto hopeless = make_part(description);
  ASSERT_FALSE(hopeless);
  EXPECT_THAT(hopeless.error().message, HasSubstr("no other unit makes its size likely"));
}

TEST(MakePart, RefusesAMeshThatIsNone) {
  const TestFolder folder;
  PartDescription description;
  description.id = "ghost";
  description.mesh_file = folder.path() / "ghost.stl";
  const auto missing = make_part(description);
  ASSERT_FALSE(missing);
  EXPECT_THAT(missing.error().message, HasSubstr("part 'ghost': mesh"));

  description.mesh_file =
      folder.write("line.stl",
                   "solid a\nfacet normal 0 0 0\nouter loop\nvertex 0 0 0\nvertex 10 0 0\n"
                   "vertex 20 0 0\nendloop\nendfacet\nendsolid a\n");
  const auto flat = make_part(description);
  ASSERT_FALSE(flat);
  EXPECT_THAT(flat.error().message, HasSubstr("have no area"));
}

// --- part.yaml --------------------------------------------------------------------------------

TEST(ReadPartFile, ReadsEveryKey) {
  const TestFolder folder;
  const auto part = read_part_file(folder.write("part.yaml", R"(
id: knob
name: A knob
bop_obj_id: 7
mesh: meshes/knob.ply
mesh_unit: in
color_rgb: [1, 2, 255]
symmetries:
  discrete:
    - {axis: [0, 0, 2], angle_deg: 180, point_mm: [10, 0, 0]}
  continuous:
    - {axis: [3, 0, 0], point_mm: [0, 5, 0]}
pick_points:
  - name: top
    position_mm: [1, 2, 3]
    approach: [0, 0, -2]
    closing: [0, 5, 0]
    approach_cone_deg: 30
    width_mm: 12
    priority: 2.5
    gripper: parallel_jaw
  - {name: face, position_mm: [0, 0, 9], gripper: suction}
)"));
  ASSERT_TRUE(part) << part.error().message;
  EXPECT_EQ(part->id, "knob");
  EXPECT_EQ(part->name, "A knob");
  EXPECT_EQ(part->bop_obj_id, 7);
  EXPECT_EQ(part->mesh_file, folder.path() / "meshes/knob.ply");
  EXPECT_EQ(part->mesh_unit, LengthUnit::kInch);
  EXPECT_THAT(part->color_rgb, ElementsAre(1, 2, 255));

  ASSERT_TRUE(part->symmetries);
  const Symmetries& symmetries = *part->symmetries;
  ASSERT_THAT(symmetries.discrete, SizeIs(1));
  const Eigen::Vector3d moved = symmetries.discrete[0] * Eigen::Vector3d(0.01, 0.01, 0);
  EXPECT_TRUE(moved.isApprox(Eigen::Vector3d(0.01, -0.01, 0), 1e-9));
  ASSERT_THAT(symmetries.continuous, SizeIs(1));
  EXPECT_TRUE(symmetries.continuous[0].axis.isApprox(Eigen::Vector3d::UnitX()));
  EXPECT_TRUE(symmetries.continuous[0].point_m.isApprox(Eigen::Vector3d(0, 0.005, 0)));

  ASSERT_THAT(part->pick_points, SizeIs(2));
  const PickPoint& top = part->pick_points[0];
  EXPECT_EQ(top.name, "top");
  EXPECT_TRUE(top.position_m.isApprox(Eigen::Vector3d(0.001, 0.002, 0.003)));
  EXPECT_TRUE(top.approach.isApprox(-Eigen::Vector3d::UnitZ()));
  EXPECT_TRUE(top.closing.isApprox(Eigen::Vector3d::UnitY()));
  EXPECT_NEAR(top.approach_cone_rad, pi / 6, 1e-12);
  EXPECT_NEAR(top.width_m, 0.012, 1e-12);
  EXPECT_EQ(top.priority, 2.5);
  EXPECT_EQ(top.gripper, "parallel_jaw");
  EXPECT_EQ(part->pick_points[1].gripper, "suction");
  EXPECT_EQ(part->pick_points[1].approach_cone_rad, PickPoint{}.approach_cone_rad);
}

TEST(ReadPartFile, TakesTheNameFromTheIdAndNeedsNoSymmetryOrPickPoint) {
  const TestFolder folder;
  const auto part = read_part_file(folder.write("part.yaml", "id: a\nmesh: a.stl\nmesh_unit: m\n"));
  ASSERT_TRUE(part) << part.error().message;
  EXPECT_EQ(part->name, "a");
  EXPECT_EQ(part->bop_obj_id, 0);
  EXPECT_FALSE(part->symmetries);
  EXPECT_THAT(part->pick_points, SizeIs(0));
}

TEST(ReadPartFile, MayStateThatThereIsNoSymmetry) {
  const TestFolder folder;
  const auto part = read_part_file(
      folder.write("part.yaml", "id: a\nmesh: a.stl\nmesh_unit: m\nsymmetries: {}\n"));
  ASSERT_TRUE(part) << part.error().message;
  ASSERT_TRUE(part->symmetries);
  EXPECT_THAT(part->symmetries->discrete, SizeIs(0));
  EXPECT_THAT(part->symmetries->continuous, SizeIs(0));
}

TEST(ReadPartFile, NamesEveryFaultWithItsPlaceAtOnce) {
  const TestFolder folder;
  const std::string faults = fault_of(folder, R"(id: two words
name: A knob
mesh: knob.stl
mesh_unit: cm
colour: [1, 2, 3]
color_rgb: [1, 2, 256]
symmetries:
  discrete:
    - {axis: [0, 0, 0], angle_deg: 180}
    - {axis: [0, 0, 1]}
  continuous:
    - {point_mm: [0, 0, 0]}
pick_points:
  - {name: a, position_mm: [0, 0, 0], approach: [0, 0, -1], closing: [0, 1, 1]}
  - {name: a, position_mm: [0, 0], approach_cone_deg: 200, width_mm: -1, gripper: hand}
  - {approach: [0, 0, 0]}
)");
  for (const char* fault :
       {"part.yaml:1: 'id' must be made of letters", "part.yaml:4: 'cm' is no unit; known: m | mm",
        "part.yaml:5: unknown key 'colour'", "part.yaml:6: 'color_rgb' must be three whole numbers",
        "part.yaml:9: 'axis' must be a direction", "part.yaml:10: key 'angle_deg' is missing",
        "part.yaml:12: key 'axis' is missing",
        "part.yaml:14: pick point 'a': 'closing' must be at right angles", "at 135.0°",
        "part.yaml:15: two pick points are named 'a'",
        "part.yaml:15: 'position_mm' must be a list of 3 numbers",
        "part.yaml:15: pick point 'a': 'approach_cone_deg' is 200: it must be above 0",
        "part.yaml:15: pick point 'a': 'width_mm' is -1: it must be from 0",
        "part.yaml:15: 'hand' is no gripper kind", "part.yaml:16: key 'name' is missing",
        "part.yaml:16: key 'position_mm' is missing",
        "part.yaml:16: 'approach' must be a direction"}) {
    EXPECT_THAT(faults, HasSubstr(fault));
  }
}

TEST(ReadPartFile, RefusesPickPointsThatCanNotBeGrasped) {
  const TestFolder folder;
  const std::string faults = fault_of(folder, R"(id: knob
mesh: knob.stl
mesh_unit: mm
pick_points:
  - {name: pin, position_mm: [0, 0, 0], approach_cone_deg: 0}
  - {name: wall, position_mm: [0, 0, 0], width_mm: 301}
  - {name: antipodal_1, position_mm: [0, 0, 0]}
  - {name: principal_axis, position_mm: [0, 0, 0]}
)");
  for (const char* fault :
       {"part.yaml:5: pick point 'pin': 'approach_cone_deg' is 0: it must be above 0, or no pose",
        "part.yaml:6: pick point 'wall': 'width_mm' is 301: it must be from 0, which has it "
        "measured, to 300, as wide as any gripper opens",
        "part.yaml:7: 'antipodal_1' is what graspd calls a pick point of its own",
        "part.yaml:8: 'principal_axis' is what graspd calls"}) {
    EXPECT_THAT(faults, HasSubstr(fault));
  }
}

TEST(ReadPartFile, MissingKeysAndMissingFile) {
  const TestFolder folder;
  const std::string faults = fault_of(folder, "name: nothing else\n");
  for (const char* key : {"id", "mesh", "mesh_unit"}) {
    EXPECT_THAT(faults, HasSubstr(fmt::format("key '{}' is missing", key)));
  }
  const auto missing = read_part_file(folder.path() / "none.yaml");
  ASSERT_FALSE(missing);
  EXPECT_THAT(missing.error().message, HasSubstr("none.yaml: can't be read"));
}

// --- symmetry groups --------------------------------------------------------------------------

Result<PartDescription> with_discrete(const TestFolder& folder, const std::string& generators) {
  return read_part_file(folder.write("part.yaml",
                                     "id: a\nmesh: a.stl\nmesh_unit: mm\n"
                                     "symmetries:\n  discrete:\n" +
                                         generators));
}

struct Group {
  std::string generators;
  std::size_t poses_n;  ///< without the identity
};

class DiscreteSymmetries : public ::testing::TestWithParam<Group> {};

TEST_P(DiscreteSymmetries, AreTheClosedGroupOfTheirGenerators) {
  const TestFolder folder;
  const auto part = with_discrete(folder, GetParam().generators);
  ASSERT_TRUE(part) << part.error().message;
  EXPECT_THAT(part->symmetries->discrete, SizeIs(GetParam().poses_n));
  expect_group(part->symmetries->discrete, 1e-3);
}

INSTANTIATE_TEST_SUITE_P(
    Generators, DiscreteSymmetries,
    ::testing::Values(
        Group{"    - {axis: [0, 0, 1], angle_deg: 60}\n", 5},
        Group{"    - {axis: [0, 0, 1], angle_deg: 51.43}\n", 6},  // 360/7, rounded
        Group{"    - {axis: [0, 0, 1], angle_deg: 90, point_mm: [30, 10, 0]}\n", 3},
        Group{"    - {axis: [0, 0, 1], angle_deg: 120}\n    - {axis: [1, 0, 0], angle_deg: 180}\n",
              5},
        Group{"    - {axis: [0, 0, 1], angle_deg: 90}\n    - {axis: [1, 0, 0], angle_deg: 90}\n",
              23},
        Group{"    - {T_mm: [-1, 0, 0, 20, 0, -1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1]}\n", 1}));

TEST(DiscreteSymmetry, AsAMatrixIsInMillimetres) {
  const TestFolder folder;
  const auto part =
      with_discrete(folder, "    - {T_mm: [-1, 0, 0, 20, 0, -1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1]}\n");
  ASSERT_TRUE(part) << part.error().message;
  const Eigen::Vector3d p = part->symmetries->discrete.at(0) * Eigen::Vector3d(0.01, 0.01, 0);
  EXPECT_TRUE(p.isApprox(Eigen::Vector3d(0.01, -0.01, 0), 1e-9));
}

TEST(DiscreteSymmetry, ThatDoesNotCloseIsAFault) {
  const TestFolder folder;
  for (const char* generators :
       {"    - {axis: [0, 0, 1], angle_deg: 47.3}\n",
        // Two axes that do not meet: their product is a translation.
        "    - {axis: [0, 0, 1], angle_deg: 180}\n"
        "    - {axis: [0, 0, 1], angle_deg: 180, point_mm: [10, 0, 0]}\n"}) {
    const auto part = with_discrete(folder, generators);
    ASSERT_FALSE(part) << generators;
    EXPECT_THAT(part.error().message, HasSubstr("a group of more than 120 poses"));
  }
  const auto mirror =
      with_discrete(folder, "    - {T_mm: [-1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1]}\n");
  ASSERT_FALSE(mirror);
  EXPECT_THAT(mirror.error().message, HasSubstr("'T_mm' is no pose"));
}

}  // namespace
}  // namespace graspd::parts
