// Solids whose turns are known from their making, in any pose, of any triangles.

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "graspd/parts/part.hpp"
#include "part_test_support.hpp"
#include "random_pose.hpp"
#include "sim_meshes.hpp"
#include "symmetry_meshes.hpp"

namespace graspd::parts {
namespace {

using ::testing::SizeIs;
using ::testing::StartsWith;

using std::numbers::pi;

struct Solid {
  std::string name;
  Mesh mesh;
  std::size_t discrete_n;  ///< without the identity
  std::size_t continuous_n;
};

/// No turn leaves its outline as it was, nor does a turn-over.
double lopsided(double angle_rad) {
  return 0.02 * (1 + 0.2 * std::cos(angle_rad) + 0.15 * std::sin(2 * angle_rad) +
                 0.1 * std::cos(3 * angle_rad));
}

std::vector<Solid> solids() {
  return {
      {"Box", box_mesh({0, 0, 0}, {0.06F, 0.04F, 0.02F}), 3, 0},
      {"NearlyCubicBox", box_mesh({0, 0, 0}, {0.06F, 0.055F, 0.05F}), 3, 0},
      {"SquarePrism", box_mesh({0, 0, 0}, {0.03F, 0.03F, 0.08F}), 7, 0},
      {"Cube", box_mesh({0, 0, 0}, {0.04F, 0.04F, 0.04F}), 23, 0},
      {"Tetrahedron", tetrahedron_mesh(0.05), 11, 0},
      {"Icosahedron", icosahedron_mesh(0.05), 59, 0},
      {"TrianglePrism", prism_mesh(3, 0.03, 0.02), 5, 0},
      {"HexagonPrism", prism_mesh(6, 0.02, 0.03), 11, 0},
      {"HexagonPrismOfAlikeMoments", prism_mesh(6, 0.02, 0.0296), 11, 0},
      {"TwistedSquarePrism", loft_mesh(4, circle(0.02), circle(0.02), 0.05, 0.3), 7, 0},
      {"Pyramid", loft_mesh(5, circle(0.03), circle(0.0001), 0.04), 4, 0},
      {"Ratchet", gear_mesh(3, 0.03, 0.008, 0.02, true), 2, 0},
      {"TallRatchet", gear_mesh(3, 0.03, 0.008, 0.05, true), 2, 0},
      {"Gear", gear_mesh(20, 0.05, 0.006, 0.02), 39, 0},
      {"GearOfManyTeeth", gear_mesh(37, 0.05, 0.004, 0.02), 73, 0},
      {"Cylinder", prism_mesh(48, 0.02, 0.08), 1, 1},
      {"CylinderOfFewSides", prism_mesh(20, 0.02, 0.03), 1, 1},
      {"CylinderOfAlikeMoments", prism_mesh(48, 0.02, 0.035), 1, 1},
      {"Pipe", testing::pipe_mesh(0.015, 0.011, 0.06), 1, 1},
      {"Cone", loft_mesh(64, circle(0.03), circle(0.0001), 0.05), 0, 1},
      {"Ball", testing::sphere_mesh(0.03, 24), 0, 2},
      {"Lopsided",
       loft_mesh(
           96, lopsided, [](double a) { return 0.7 * lopsided(a); }, 0.03),
       0, 0},
  };
}

class FindSymmetries : public ::testing::TestWithParam<Solid> {
 protected:
  const Mesh& mesh() const { return GetParam().mesh; }
  std::mt19937 random_{7};
};

INSTANTIATE_TEST_SUITE_P(Solids, FindSymmetries, ::testing::ValuesIn(solids()),
                         [](const auto& test) { return test.param.name; });

Eigen::Isometry3d turn_about(const ContinuousSymmetry& symmetry, double angle_rad) {
  return Eigen::Translation3d(symmetry.point_m) * Eigen::AngleAxisd(angle_rad, symmetry.axis) *
         Eigen::Translation3d(-symmetry.point_m);
}

/// The farthest that a pose moves vertices and middles of triangles off the surface.
double moved_off_m(const Mesh& mesh, const Eigen::Isometry3d& T) {
  double worst_m = 0;
  const std::size_t step = 1 + mesh.triangles.size() / 150;
  for (std::size_t i = 0; i < mesh.triangles.size(); i += step) {
    Eigen::Vector3d middle_m = Eigen::Vector3d::Zero();
    for (const int index : mesh.triangles[i]) {
      const Eigen::Vector3d p_m = mesh.vertices_m[static_cast<std::size_t>(index)].cast<double>();
      middle_m += p_m / 3;
      worst_m = std::max(worst_m, distance_m(mesh, (T * p_m).cast<float>()));
    }
    worst_m = std::max(worst_m, distance_m(mesh, (T * middle_m).cast<float>()));
  }
  return worst_m;
}

TEST_P(FindSymmetries, FindsThoseOfTheSolidAndNoOthers) {
  const Symmetries found = find_symmetries(mesh());
  EXPECT_THAT(found.discrete, SizeIs(GetParam().discrete_n));
  EXPECT_THAT(found.continuous, SizeIs(GetParam().continuous_n));
}

TEST_P(FindSymmetries, MapTheSurfaceOntoItself) {
  const Symmetries found = find_symmetries(mesh());
  const double tolerance_m = 0.0101 * diameter_m(mesh());
  for (const Eigen::Isometry3d& T : found.discrete) {
    EXPECT_NEAR(T.linear().determinant(), 1, 1e-9);
    EXPECT_GT(Eigen::AngleAxisd(T.linear()).angle(), 0.05);  // not the identity
    EXPECT_LT(moved_off_m(mesh(), T), tolerance_m) << T.matrix();
  }
  for (const ContinuousSymmetry& symmetry : found.continuous) {
    EXPECT_NEAR(symmetry.axis.norm(), 1, 1e-9);
    for (const double angle_rad : {0.03, 0.4, 1.0, 2.5}) {
      EXPECT_LT(moved_off_m(mesh(), turn_about(symmetry, angle_rad)), tolerance_m);
    }
  }
}

TEST_P(FindSymmetries, AreAGroupToTheLastDigits) {
  expect_group(find_symmetries(mesh()).discrete, 1e-6);
}

/// Where the part's symmetries should be once it has moved.
void expect_moved(const Symmetries& before, const Symmetries& after, const Eigen::Isometry3d& T) {
  ASSERT_THAT(after.discrete, SizeIs(before.discrete.size()));
  ASSERT_THAT(after.continuous, SizeIs(before.continuous.size()));
  if (before.continuous.size() == 2) return;  // of a ball any two axes will do
  for (std::size_t i = 0; i < before.continuous.size(); ++i) {
    const Eigen::Vector3d axis = T.linear() * before.continuous[i].axis;
    EXPECT_GT(std::abs(axis.dot(after.continuous[i].axis)), std::cos(0.01));
    const Eigen::Vector3d aside_m = T * before.continuous[i].point_m - after.continuous[i].point_m;
    EXPECT_LT(aside_m.cross(axis).norm(), 1e-4);
  }
  if (!before.continuous.empty()) return;  // of the turns across any one will do
  for (const Eigen::Isometry3d& symmetry : before.discrete) {
    const Eigen::Matrix4d moved = (T * symmetry * T.inverse()).matrix();
    const bool is_there = std::any_of(
        after.discrete.begin(), after.discrete.end(),
        [&](const auto& other) { return (other.matrix() - moved).cwiseAbs().maxCoeff() < 0.03; });
    EXPECT_TRUE(is_there) << moved;
  }
}

TEST_P(FindSymmetries, MoveWithThePartAndDoNotDependOnItsTriangles) {
  const Symmetries before = find_symmetries(mesh());
  for (int i = 0; i < 3; ++i) {
    const Eigen::Isometry3d T =
        Eigen::Translation3d(testing::random_point(random_, 0.4F).cast<double>()) *
        testing::random_rotation(random_);
    const std::size_t triangles_n = mesh().triangles.size() + 800U * static_cast<unsigned>(i);
    const Mesh other = moved(exploded(resplit(mesh(), random_, triangles_n)), T);
    expect_moved(before, find_symmetries(other), T);
  }
}

TEST_P(FindSymmetries, StandASurfaceThatIsOffByAFifthOfTheTolerance) {
  const Mesh noisy = with_noise(mesh(), random_, 0.002 * diameter_m(mesh()));
  const Symmetries found = find_symmetries(noisy);
  EXPECT_THAT(found.discrete, SizeIs(GetParam().discrete_n));
  EXPECT_THAT(found.continuous, SizeIs(GetParam().continuous_n));
  expect_group(found.discrete, 1e-6);
}

TEST_P(FindSymmetries, AreTheSameEachTime) {
  const Symmetries once = find_symmetries(mesh());
  const Symmetries again = find_symmetries(mesh());
  ASSERT_EQ(once.discrete.size(), again.discrete.size());
  for (std::size_t i = 0; i < once.discrete.size(); ++i) {
    EXPECT_EQ(once.discrete[i].matrix(), again.discrete[i].matrix());
  }
  for (std::size_t i = 0; i < once.continuous.size(); ++i) {
    EXPECT_EQ(once.continuous[i].axis, again.continuous[i].axis);
    EXPECT_EQ(once.continuous[i].point_m, again.continuous[i].point_m);
  }
}

/// A round bar of 60 mm with a flat along it, 62 mm across.
Mesh bar_with_flat(double depth_m) {
  const Outline outline = [=](double angle_rad) {
    return std::min(0.01, (0.01 - depth_m) / std::max(1e-3, std::cos(angle_rad)));
  };
  return loft_mesh(180, outline, outline, 0.06);
}

TEST(Symmetries, HoldToOnePerCentOfTheDiameter) {
  const Symmetries shallow = find_symmetries(bar_with_flat(0.0004));
  EXPECT_THAT(shallow.continuous, SizeIs(1));
  EXPECT_THAT(shallow.discrete, SizeIs(1));
  const Symmetries deep = find_symmetries(bar_with_flat(0.002));
  EXPECT_THAT(deep.continuous, SizeIs(0));
  ASSERT_THAT(deep.discrete, SizeIs(1));  // over, about the line through the flat's middle
  const Eigen::AngleAxisd turn(deep.discrete[0].linear());
  EXPECT_NEAR(turn.angle(), pi, 1e-6);
  EXPECT_NEAR(std::abs(turn.axis().x()), 1, 1e-3);
}

TEST(Symmetries, DoNotMindATriangleWithoutAreaAside) {
  Mesh mesh = box_mesh({0, 0, 0}, {0.06F, 0.04F, 0.02F});
  const int far_corner = static_cast<int>(mesh.vertices_m.size());
  mesh.vertices_m.emplace_back(0.03F, 0.03F, 0.025F);
  mesh.triangles.push_back({far_corner, far_corner, far_corner});
  EXPECT_THAT(find_symmetries(mesh).discrete, SizeIs(3));
}

TEST(Symmetries, OfASurfaceWithoutAreaAreNone) {
  const Symmetries none = find_symmetries(Mesh{});
  EXPECT_THAT(none.discrete, SizeIs(0));
  EXPECT_THAT(none.continuous, SizeIs(0));
}

TEST(Symmetries, AreSaidInOneLineByPartCheck) {
  EXPECT_THAT(symmetries_line(box_mesh({-0.03F, -0.03F, 0}, {0.06F, 0.06F, 0.02F})),
              StartsWith("symmetries_discrete: 7 (180° about 4 axes, 90° about (0, 0, 1)); "
                         "symmetries_continuous: 0. If that is wrong, part.yaml"));
  EXPECT_THAT(symmetries_line(moved(prism_mesh(48, 0.02, 0.08),
                                    Eigen::Isometry3d(Eigen::Translation3d(0.01, 0.02, -0.04)))),
              StartsWith("symmetries_discrete: 1 (180° about (1, 0, 0) through (0, 20, 0) mm); "
                         "symmetries_continuous: 1 (about (0, 0, 1) through (10, 20, 0) mm)."));
  EXPECT_THAT(symmetries_line(testing::sphere_mesh(0.03, 24)),
              StartsWith("symmetries_discrete: 0; symmetries_continuous: 2 (any turn: a ball)."));
}

}  // namespace
}  // namespace graspd::parts
