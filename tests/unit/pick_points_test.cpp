// Pick points of the delivered parts and of unseen meshes: that each proposed one can be held where
// it says, and that none is left out or double under the part's symmetries.

#include <gmock/gmock.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

#include "antipodal_pairs.hpp"
#include "graspd/parts/part.hpp"
#include "graspd/types/request.hpp"
#include "part_test_support.hpp"
#include "pick_point_images.hpp"
#include "pick_point_support.hpp"
#include "propose_pick_points.hpp"
#include "sim_meshes.hpp"
#include "symmetry_meshes.hpp"

namespace graspd::parts {
namespace {

using Eigen::Vector3d;
using ::testing::IsEmpty;
using ::testing::SizeIs;

using std::numbers::pi;
/// By which a found symmetry may move the surface off itself.
constexpr double kSame_m = 1e-4;
const double kFrictionAngle_rad = std::atan(0.4);

Part load(const std::string& name) {
  const auto own = own_parts_folder() / name / "part.yaml";
  if (std::filesystem::exists(own)) return read_part_file(own).and_then(make_part).value();
  PartDescription description;
  description.id = name;
  description.mesh_file =
      std::filesystem::path(GRASPD_SOURCE_DIR) / "tests/data/unseen" / (name + ".stl");
  return make_part(description).value();
}

bool is_cup(const PickPoint& point) { return point.gripper == "suction"; }

/// Each where it was found: images lie on the surface as truly as the symmetries do.
std::vector<PickPoint> proposed_once(const Part& part, bool cups) {
  std::vector<PickPoint> points = only(part, true, cups);
  const auto same_name = [](const PickPoint& a, const PickPoint& b) { return a.name == b.name; };
  points.erase(std::unique(points.begin(), points.end(), same_name), points.end());
  return points;
}

class PickPoints : public ::testing::TestWithParam<std::string> {
 protected:
  const Part& part() const {
    static std::map<std::string, Part> loaded;
    if (!loaded.contains(GetParam())) loaded[GetParam()] = load(GetParam());
    return loaded[GetParam()];
  }
};

INSTANTIATE_TEST_SUITE_P(All, PickPoints,
                         ::testing::Values("tee", "elbow", "straight_pipe", "hex_bolt", "l_bracket",
                                           "flanged_ring", "saddle_clamp", "stepped_shaft",
                                           "u_channel"),
                         [](const auto& test) { return test.param; });

/// Of the triangles through a point, the least angle of a normal to a direction.
double normal_angle_rad(const Mesh& mesh, const Vector3d& p_m, const Vector3d& direction) {
  double least_rad = pi;
  for (const auto& [a, b, c] : mesh.triangles) {
    const auto& corner_a = mesh.vertices_m[static_cast<std::size_t>(a)];
    const auto& corner_b = mesh.vertices_m[static_cast<std::size_t>(b)];
    const auto& corner_c = mesh.vertices_m[static_cast<std::size_t>(c)];
    if (squared_distance(p_m.cast<float>(), corner_a, corner_b, corner_c) > kSame_m * kSame_m) {
      continue;
    }
    const Vector3d normal = (corner_b - corner_a).cross(corner_c - corner_a).cast<double>();
    least_rad =
        std::min(least_rad, std::acos(std::clamp(normal.normalized().dot(direction), -1.0, 1.0)));
  }
  return least_rad;
}

Eigen::Isometry3d T_part_grasp(const PickPoint& point, double turn_rad = 0) {
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  T.linear() << point.closing, point.approach.cross(point.closing), point.approach;
  T.translation() = point.position_m;
  T.rotate(Eigen::AngleAxisd(turn_rad, Vector3d::UnitX()));
  T.translate(Vector3d(0, 0, point.tip_reach_m));
  return T;
}

TEST_P(PickPoints, ProposedContactsLieOnTheSurfaceWithinBothFrictionCones) {
  const auto points = proposed_once(part(), false);
  EXPECT_GE(points.size(), 4U);
  for (const PickPoint& point : points) {
    SCOPED_TRACE(point.name);
    EXPECT_NEAR(point.closing.norm(), 1, 1e-9);
    for (const double side : {-1.0, 1.0}) {
      const Vector3d contact_m = point.position_m + side * point.width_m / 2 * point.closing;
      EXPECT_LT(distance_m(part().mesh, contact_m.cast<float>()), kSame_m);
      EXPECT_LE(normal_angle_rad(part().mesh, contact_m, side * point.closing),
                kFrictionAngle_rad + 0.01);
    }
  }
}

TEST_P(PickPoints, ProposedPadsTouchASurfaceNotAPoint) {
  const double radius_m = pad_radius_m(part().diameter_m);
  const auto surface = sample_surface(part().mesh, 0.0005);
  for (const PickPoint& point : proposed_once(part(), false)) {
    SCOPED_TRACE(point.name);
    for (const double side : {-1.0, 1.0}) {
      const Vector3d contact_m = point.position_m + side * point.width_m / 2 * point.closing;
      const auto touching_n =
          std::count_if(surface.begin(), surface.end(), [&](const SurfacePoint& s) {
            const Vector3d d_m = s.position_m.cast<double>() - contact_m;
            const double deep_m = std::abs(point.closing.dot(d_m));
            return deep_m < 0.0006 && d_m.squaredNorm() < radius_m * radius_m;
          });
      EXPECT_GT(static_cast<double>(touching_n) * 0.0005 * 0.0005, 0.2 * pi * radius_m * radius_m);
    }
  }
}

TEST_P(PickPoints, OpenJawsReachProposedPointsOverTheirWholeCone) {
  constexpr double kMargin_m = 0.001;  // the jaws are tried against points 2 mm apart
  const Gripper gripper;
  const auto surface = sample_surface(part().mesh, 0.001);
  for (const PickPoint& point : proposed_once(part(), false)) {
    SCOPED_TRACE(point.name);
    EXPECT_GT(point.approach_cone_rad, 0.2);
    const double inner_m = point.width_m / 2 + kMargin_m;
    const double outer_m = point.width_m / 2 + gripper.clearance_m + gripper.jaw_size_m.x();
    for (const double share : {-1.0, -0.5, 0.0, 0.5, 1.0}) {
      const auto T = T_part_grasp(point, share * point.approach_cone_rad).inverse();
      const bool is_met = std::any_of(surface.begin(), surface.end(), [&](const SurfacePoint& s) {
        const Vector3d p = T * s.position_m.cast<double>();
        const double across_m = std::abs(p.x());
        return across_m > inner_m && across_m < outer_m - kMargin_m && p.z() < -kMargin_m &&
               std::abs(p.y()) < gripper.jaw_size_m.y() / 2 - kMargin_m;
      });
      EXPECT_FALSE(is_met) << "turned by " << share << " of the cone";
    }
  }
}

TEST_P(PickPoints, ProposedPatchesAreFlatAndOpenToTheOutside) {
  const auto points = proposed_once(part(), true);
  EXPECT_FALSE(points.empty());
  const auto surface = sample_surface(part().mesh, 0.001);
  for (const PickPoint& point : points) {
    SCOPED_TRACE(point.name);
    const double radius_m = point.width_m / 2;
    EXPECT_GE(radius_m, 0.0029);
    EXPECT_LE(normal_angle_rad(part().mesh, point.position_m, -point.approach), 0.01);
    const double sag_m = std::max(0.0002, 0.12 * radius_m) + kSame_m;
    int sealing_n = 0;
    int above_n = 0;
    for (const SurfacePoint& s : surface) {
      const Vector3d d_m = s.position_m.cast<double>() - point.position_m;
      const double height_m = -point.approach.dot(d_m);
      if ((d_m + height_m * point.approach).norm() > 0.9 * radius_m) continue;
      sealing_n += std::abs(height_m) <= sag_m ? 1 : 0;
      above_n += height_m > sag_m ? 1 : 0;
    }
    EXPECT_EQ(above_n, 0);
    EXPECT_GT(sealing_n, 0.6 * pi * radius_m * radius_m * 1e6);
  }
}

TEST_P(PickPoints, AreTheImagesOfTheFirstOfTheirNameAndNoneIsDouble) {
  const auto turns = turns_of(part().symmetries);
  const auto& points = part().pick_points;
  for (std::size_t i = 0; i < points.size(); ++i) {
    SCOPED_TRACE(points[i].name);
    const auto first = std::find_if(points.begin(), points.end(),
                                    [&](const PickPoint& p) { return p.name == points[i].name; });
    EXPECT_TRUE(std::any_of(turns.begin(), turns.end(), [&](const Eigen::Isometry3d& T) {
      return (T * first->position_m - points[i].position_m).norm() < 1e-9 &&
             (T.linear() * first->approach - points[i].approach).norm() < 1e-9 &&
             (T.linear() * first->closing - points[i].closing).norm() < 1e-9;
    }));
    EXPECT_EQ(first->width_m, points[i].width_m);
    for (std::size_t j = 0; j < i; ++j) EXPECT_FALSE(is_same_grasp(points[i], points[j])) << j;
  }
}

TEST_P(PickPoints, HaveTheImageOfEachUnderEachSymmetry) {
  const auto& symmetries = part().symmetries;
  std::vector<Eigen::Isometry3d> turns = symmetries.discrete;
  for (const ContinuousSymmetry& symmetry : symmetries.continuous) {
    turns.emplace_back(Eigen::Translation3d(symmetry.point_m) *
                       Eigen::AngleAxisd(pi / 4, symmetry.axis) *
                       Eigen::Translation3d(-symmetry.point_m));
  }
  for (const PickPoint& point : part().pick_points) {
    SCOPED_TRACE(point.name);
    for (const Eigen::Isometry3d& T : turns) {
      const PickPoint image = images_of(point, {T}).front();
      EXPECT_TRUE(std::any_of(part().pick_points.begin(), part().pick_points.end(),
                              [&](const PickPoint& p) { return is_same_grasp(p, image); }));
    }
  }
}

TEST_P(PickPoints, TurnsOfTheSymmetriesLayTheSurfaceOverItself) {
  const auto surface = sample_surface(part().mesh, 0.006);
  for (const Eigen::Isometry3d& T : turns_of(part().symmetries)) {
    for (const SurfacePoint& s : surface) {
      const Vector3d p_m = T * s.position_m.cast<double>();
      // Of a tessellated round surface, corners turn over faces.
      ASSERT_LT(distance_m(part().mesh, p_m.cast<float>()), 0.01 * part().diameter_m);
    }
  }
}

TEST_P(PickPoints, TaughtOnesHaveTheHigherPriorityAndProposalsAreFew) {
  const auto& points = part().pick_points;
  const auto first_proposed =
      std::find_if(points.begin(), points.end(), [](const PickPoint& p) { return p.is_proposed; });
  for (auto taught = points.begin(); taught != first_proposed; ++taught) {
    for (auto proposed = first_proposed; proposed != points.end(); ++proposed) {
      ASSERT_TRUE(proposed->is_proposed);
      // An approach straight down counts 1 more than one along the floor.
      ASSERT_LE(proposed->priority, taught->priority - 0.5);
    }
  }
  const auto proposals = propose_pick_points(part());
  for (const bool cups : {false, true}) {
    EXPECT_LE(std::count_if(proposals.begin(), proposals.end(),
                            [&](const PickPoint& p) { return is_cup(p) == cups; }),
              24);
  }
  EXPECT_LE(
      std::count_if(points.begin(), points.end(), [](const PickPoint& p) { return p.is_proposed; }),
      2 * 4 * 48);
}

TEST_P(PickPoints, AreTheSameOnEveryRun) {
  const auto a = propose_pick_points(part());
  const auto b = propose_pick_points(part());
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i) {
    EXPECT_EQ(a[i].name, b[i].name);
    EXPECT_EQ(a[i].position_m, b[i].position_m);
    EXPECT_EQ(a[i].approach, b[i].approach);
  }
}

// --- parts whose pick points can be written down -------------------------------------------------

TEST(ProposedPickPoints, OfABoxCloseAlongItsAxes) {
  const TestFolder folder;
  const auto part = box_with(folder, across_the_box());
  std::array<int, 3> along_n{};
  for (const PickPoint& point : only(*part, true, false)) {
    Eigen::Index axis = 0;
    EXPECT_NEAR(point.closing.cwiseAbs().maxCoeff(&axis), 1, 1e-6);
    ++along_n[static_cast<std::size_t>(axis)];
    EXPECT_NEAR(point.width_m, Vector3d(0.06, 0.04, 0.02)[axis], 1e-6);
    EXPECT_NEAR(point.position_m[axis], 0, 1e-6);
  }
  for (const int n : along_n) EXPECT_GT(n, 0);
}

TEST(ProposedPickPoints, FacesThatLeanTowardsEachOtherAreHeldOnlyWithinFriction) {
  // A tapered bar: its long sides lean in by half of the angle each.
  const auto pairs_of = [](double half_angle_rad) {
    const auto lean = static_cast<float>(std::tan(half_angle_rad));
    Mesh mesh = box_mesh({-0.05F, -0.01F, -0.02F}, {0.1F, 0.02F, 0.04F}, 8);
    for (auto& v : mesh.vertices_m) v.y() *= 1 + lean * v.z() / 0.01F;
    std::vector<AntipodalPair> across;
    for (const auto& pair : antipodal_pairs(mesh, TriangleTree(mesh), diameter_m(mesh))) {
      if (std::abs(pair.closing.y()) > 0.9) across.push_back(pair);
    }
    return across;
  };
  const auto gentle = pairs_of(0.05);
  EXPECT_FALSE(gentle.empty());
  for (const auto& pair : gentle) EXPECT_NEAR(pair.friction_margin, 1 - 0.05 / 0.38, 0.15);
  EXPECT_THAT(pairs_of(0.42), IsEmpty());
}

TEST(ProposedPickPoints, OfABallComeFromAllSides) {
  const TestFolder folder;
  PickPoint point = across_the_box();
  point.position_m = Vector3d::Zero();
  point.width_m = 0.040;
  const auto part = box_with(folder, point, testing::sphere_mesh(0.02, 48));
  ASSERT_TRUE(part) << part.error().message;
  ASSERT_THAT(part->symmetries.continuous, SizeIs(2));
  const auto taught = only(*part, false, false);
  EXPECT_THAT(taught, SizeIs(30));  // 60 turns, of which one in two only swaps the jaws
  for (const Eigen::Vector3f& down : spread_directions(200)) {
    const auto nearest = std::max_element(taught.begin(), taught.end(), [&](auto& a, auto& b) {
      return a.approach.dot(down.cast<double>()) < b.approach.dot(down.cast<double>());
    });
    EXPECT_GT(nearest->approach.dot(down.cast<double>()), std::cos(0.7));
  }
}

}  // namespace
}  // namespace graspd::parts
