// The catalogue that is delivered: that its meshes are sound, that the symmetries found are those
// of the parts and no others are left out, and that a parallel gripper can take the parts where it
// says.

#include <gmock/gmock.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "graspd/parts/catalogue.hpp"
#include "graspd/parts/mesh_check.hpp"
#include "graspd/types/request.hpp"
#include "part_test_support.hpp"
#include "symmetry_meshes.hpp"

namespace graspd::parts {
namespace {

using ::testing::ElementsAre;
using ::testing::StartsWith;

const Catalogue& own_catalogue() {
  static const Catalogue catalogue = Catalogue::load(own_parts_folder()).value();
  return catalogue;
}

class OwnPart : public ::testing::TestWithParam<std::string> {
 protected:
  const Part& part() const { return *own_catalogue().find(GetParam()); }
  std::filesystem::path file(const std::string& extension) const {
    return own_parts_folder() / GetParam() / (GetParam() + extension);
  }
};

INSTANTIATE_TEST_SUITE_P(All, OwnPart,
                         ::testing::Values("tee", "elbow", "straight_pipe", "hex_bolt", "l_bracket",
                                           "flanged_ring"),
                         [](const auto& test) { return test.param; });

TEST(OwnCatalogue, HoldsSixPartsNumberedOneToSix) {
  std::vector<std::string> ids;
  for (int number = 1; number <= 6; ++number) ids.push_back(own_catalogue().find_bop(number)->id);
  EXPECT_THAT(
      ids, ElementsAre("tee", "elbow", "straight_pipe", "hex_bolt", "l_bracket", "flanged_ring"));
  EXPECT_EQ(own_catalogue().parts().size(), 6U);
}

TEST_P(OwnPart, HasAMeshWithNothingToFind) {
  SensorResolution sensor;
  sensor.distance_m = 0.75;
  for (const MeshFinding& finding : check_mesh(part().mesh, sensor)) {
    EXPECT_EQ(finding.severity, Severity::kOk) << finding.topic << ": " << finding.sentence;
  }
  EXPECT_TRUE(std::filesystem::exists(file(".scad")));
  EXPECT_LT(std::filesystem::file_size(file(".stl")), 200'000U);
  EXPECT_LT(part().mesh.triangles.size(), 4000U);
}

// --- symmetries -------------------------------------------------------------------------------

constexpr double kTessellation_m = 0.0001;
constexpr double kOther_m = 0.001;

/// The farthest that a pose moves the surface away from itself; looks no farther beyond kOther_m.
double residual_m(const Part& part, const Eigen::Isometry3d& T) {
  double worst = 0;
  for (const SurfacePoint& point : sample_surface(part.mesh, 0.004)) {
    if (worst > kOther_m) break;
    worst =
        std::max(worst, distance_m(part.mesh, (T * point.position_m.cast<double>()).cast<float>()));
  }
  return worst;
}

Eigen::Isometry3d turn_about(const Eigen::Vector3d& point_m, const Eigen::Vector3d& axis,
                             double angle_rad) {
  return Eigen::Translation3d(point_m) * Eigen::AngleAxisd(angle_rad, axis) *
         Eigen::Translation3d(-point_m);
}

/// Whether the part's symmetries, products of them included, hold this pose.
bool is_found(const Symmetries& symmetries, const Eigen::Isometry3d& T) {
  std::vector<Eigen::Isometry3d> found = symmetries.discrete;
  found.push_back(Eigen::Isometry3d::Identity());
  return std::any_of(found.begin(), found.end(), [&](const Eigen::Isometry3d& D) {
    const Eigen::Isometry3d rest = T * D.inverse();
    if (rest.isApprox(Eigen::Isometry3d::Identity(), 1e-3)) return true;
    return std::any_of(symmetries.continuous.begin(), symmetries.continuous.end(),
                       [&](const ContinuousSymmetry& c) {
                         const Eigen::Vector3d on_axis_m = c.point_m + 0.1 * c.axis;
                         return (rest * c.point_m - c.point_m).norm() < 1e-4 &&
                                (rest * on_axis_m - on_axis_m).norm() < 1e-4;
                       });
  });
}

TEST(OwnCatalogue, HasTheSymmetriesThatTheCadSourcesSay) {
  const auto sentence = [](const std::string& id) {
    return symmetries_line(own_catalogue().find(id)->mesh);
  };
  EXPECT_THAT(sentence("tee"), StartsWith("symmetries_discrete: 1 (180° about (0, 1, 0)); "
                                          "symmetries_continuous: 0."));
  EXPECT_THAT(sentence("elbow"),
              StartsWith("symmetries_discrete: 1 (180° about (0.707, 0.707, 0)); "
                         "symmetries_continuous: 0."));
  EXPECT_THAT(sentence("straight_pipe"),
              StartsWith("symmetries_discrete: 1 (180° about (1, 0, 0)); "
                         "symmetries_continuous: 1 (about (0, 0, 1))."));
  EXPECT_THAT(sentence("hex_bolt"), StartsWith("symmetries_discrete: 5 (60° about (0, 0, 1)); "
                                               "symmetries_continuous: 0."));
  EXPECT_THAT(sentence("l_bracket"),
              StartsWith("symmetries_discrete: 0; symmetries_continuous: 0."));
  EXPECT_THAT(sentence("flanged_ring"),
              StartsWith("symmetries_discrete: 0; symmetries_continuous: 1 (about (0, 0, 1))."));
}

TEST_P(OwnPart, FoundSymmetriesMapTheSurfaceOntoItself) {
  for (const Eigen::Isometry3d& T : part().symmetries.discrete) {
    EXPECT_LT(residual_m(part(), T), kTessellation_m) << T.matrix();
  }
  for (const ContinuousSymmetry& symmetry : part().symmetries.continuous) {
    for (const double angle_rad : {0.05, 1.0, 2.5}) {
      EXPECT_LT(residual_m(part(), turn_about(symmetry.point_m, symmetry.axis, angle_rad)),
                kTessellation_m);
    }
  }
}

TEST_P(OwnPart, NoOtherTurnAboutAPrincipalAxisDoes) {
  for (int axis = 0; axis < 3; ++axis) {
    for (const int angle_deg : {45, 60, 72, 90, 120, 180, 270}) {
      const Eigen::Isometry3d T = turn_about(part().barycentre_m, part().principal_axes.col(axis),
                                             angle_deg * std::numbers::pi / 180);
      const double moved_m = residual_m(part(), T);
      if (is_found(part().symmetries, T)) {
        EXPECT_LT(moved_m, kTessellation_m) << "axis " << axis << ", " << angle_deg << "°";
      } else {
        EXPECT_GT(moved_m, kOther_m) << "axis " << axis << ", " << angle_deg << "°";
      }
    }
  }
}

// --- pick points ------------------------------------------------------------------------------

/// Where a line crosses the surface, as signed distances from its origin, in order.
std::vector<double> crossings_m(const Mesh& mesh, const Eigen::Vector3d& origin_m,
                                const Eigen::Vector3d& direction) {
  std::vector<double> crossings;
  for (const auto& t : mesh.triangles) {
    Eigen::Matrix3d corners;
    for (int k = 0; k < 3; ++k) {
      corners.col(k) =
          mesh.vertices_m[static_cast<std::size_t>(t[static_cast<std::size_t>(k)])].cast<double>();
    }
    // origin + s·direction = a + u·(b − a) + v·(c − a)
    Eigen::Matrix3d system;
    system << -direction, corners.col(1) - corners.col(0), corners.col(2) - corners.col(0);
    if (std::abs(system.determinant()) < 1e-15) continue;
    const Eigen::Vector3d suv = system.inverse() * (origin_m - corners.col(0));
    if (suv[1] >= 0 && suv[2] >= 0 && suv[1] + suv[2] <= 1) crossings.push_back(suv[0]);
  }
  std::sort(crossings.begin(), crossings.end());
  return crossings;
}

struct Span {
  double from_m = 0;
  double to_m = 0;
};

/// What lies between the jaws: the solid around the pick point, or, where that is in a bore, all
/// from the outer wall to the outer wall.
Span span_between_jaws(const Mesh& mesh, const PickPoint& point) {
  // A little aside, so that the line meets no edge of a triangle.
  const Eigen::Vector3d aside_m =
      1e-5 * (0.37 * point.approach + 0.71 * point.approach.cross(point.closing));
  const auto crossings = crossings_m(mesh, point.position_m + aside_m, point.closing);
  EXPECT_EQ(crossings.size() % 2, 0U);
  for (std::size_t i = 0; i + 1 < crossings.size(); i += 2) {
    if (crossings[i] <= 0 && crossings[i + 1] >= 0) return {crossings[i], crossings[i + 1]};
  }
  EXPECT_FALSE(crossings.empty());
  return crossings.empty() ? Span{} : Span{crossings.front(), crossings.back()};
}

std::vector<PickPoint> taught(const Part& part) {
  std::vector<PickPoint> points = part.pick_points;
  std::erase_if(points, [](const PickPoint& point) { return point.is_proposed; });
  return points;
}

TEST_P(OwnPart, PickPointsSpanSolidMaterialOfTheStatedWidth) {
  EXPECT_FALSE(taught(part()).empty());
  for (const PickPoint& point : taught(part())) {
    SCOPED_TRACE(point.name);
    const Span span = span_between_jaws(part().mesh, point);
    EXPECT_NEAR(span.to_m - span.from_m, point.width_m, 0.001);
    EXPECT_NEAR(0.5 * (span.to_m + span.from_m), 0, 0.001);  // midway between the finger tips
    EXPECT_NEAR(point.approach.dot(point.closing), 0, 1e-9);
  }
}

/// The default gripper's jaws at an opening, as boxes in the grasp frame.
std::array<Eigen::AlignedBox3d, 2> jaws_at(double opening_m) {
  const Eigen::Vector3d size = Gripper{}.jaw_size_m;
  const double inner_m = 0.5 * opening_m;
  return {Eigen::AlignedBox3d(Eigen::Vector3d(inner_m, -size.y() / 2, -size.z()),
                              Eigen::Vector3d(inner_m + size.x(), size.y() / 2, 0)),
          Eigen::AlignedBox3d(Eigen::Vector3d(-inner_m - size.x(), -size.y() / 2, -size.z()),
                              Eigen::Vector3d(-inner_m, size.y() / 2, 0))};
}

TEST_P(OwnPart, JawsReachThePickPointsOpenAndTouchThePartClosed) {
  constexpr double kTouch_m = 0.0005;
  const auto surface_points = sample_surface(part().mesh, 0.001);
  for (const PickPoint& point : taught(part())) {
    SCOPED_TRACE(point.name);
    Eigen::Isometry3d T_part_grasp = Eigen::Isometry3d::Identity();
    T_part_grasp.linear() << point.closing, point.approach.cross(point.closing), point.approach;
    T_part_grasp.translation() = point.position_m;
    const double open_m = point.width_m + 2 * Gripper{}.clearance_m;
    EXPECT_LE(open_m, Gripper{}.max_opening_m);

    std::array<int, 2> touching_n{};
    for (const SurfacePoint& surface : surface_points) {
      const Eigen::Vector3d p = T_part_grasp.inverse() * surface.position_m.cast<double>();
      for (std::size_t side = 0; side < 2; ++side) {
        EXPECT_FALSE(jaws_at(open_m)[side].contains(p)) << p.transpose();
        EXPECT_FALSE(jaws_at(point.width_m + 2 * kTouch_m)[side].contains(p)) << p.transpose();
        touching_n[side] += jaws_at(point.width_m - 2 * kTouch_m)[side].contains(p) ? 1 : 0;
      }
      EXPECT_GT(p.z(), -Gripper{}.jaw_size_m.z()) << "the palm would hit the part";
    }
    // Square millimetres, about.
    EXPECT_GE(touching_n[0], 30);
    EXPECT_GE(touching_n[1], 30);
  }
}

}  // namespace
}  // namespace graspd::parts
