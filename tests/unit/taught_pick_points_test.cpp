// What a part file teaches must be true of the mesh.

#include <gmock/gmock.h>

#include <functional>

#include "pick_point_support.hpp"

namespace graspd::parts {
namespace {

using Eigen::Vector3d;
using ::testing::HasSubstr;
using ::testing::SizeIs;

std::string fault_with(const std::function<void(PickPoint&)>& change) {
  const TestFolder folder;
  PickPoint point = across_the_box();
  change(point);
  const auto part = box_with(folder, point);
  EXPECT_FALSE(part);
  if (part) return {};
  EXPECT_EQ(part.error().code, Code::kInvalidArgument);
  EXPECT_THAT(part.error().message,
              HasSubstr((folder.path() / "part.yaml").string() + ": pick point 'top': "));
  return part.error().message;
}

TEST(TaughtPickPoints, ThatFitTheMeshAreTakenAndExpanded) {
  const TestFolder folder;
  const auto part = box_with(folder, across_the_box());
  ASSERT_TRUE(part) << part.error().message;
  // Half turns about x, y and z: to the other end, and from below at either end.
  EXPECT_THAT(only(*part, false, false), SizeIs(4));
}

TEST(TaughtPickPoints, OutsideOfTheMeshIsNamedWithItsBox) {
  const auto fault = fault_with([](PickPoint& p) { p.position_m.x() = 10; });
  EXPECT_THAT(fault, HasSubstr("position_mm (1e+04, 0, 2) lies outside of the mesh"));
  EXPECT_THAT(fault, HasSubstr("from (-30, -20, -10) to (30, 20, 10)"));
}

TEST(TaughtPickPoints, WidthThatTheMeshDoesNotHaveIsNamedWithTheRightOne) {
  for (const double wrong_m : {0.020, 0.044}) {
    const auto fault = fault_with([&](PickPoint& p) { p.width_m = wrong_m; });
    EXPECT_THAT(fault, HasSubstr(fmt::format("width_mm is {:.0f}", wrong_m * 1e3)));
    EXPECT_THAT(fault, HasSubstr("40.0 mm wide"));
  }
}

TEST(TaughtPickPoints, NotMidwayBetweenTheJawsIsNamedWithTheRightPlace) {
  const auto fault = fault_with([](PickPoint& p) { p.position_m.y() = 0.005; });
  EXPECT_THAT(fault, HasSubstr("not midway between the jaws"));
  EXPECT_THAT(fault, HasSubstr("-25.0 mm and 15.0 mm"));
  EXPECT_THAT(fault, HasSubstr("(10, 0, 2) is"));
}

TEST(TaughtPickPoints, WithNothingBetweenTheJaws) {
  // Above the box, where the jaws reach down to.
  EXPECT_THAT(fault_with([](PickPoint& p) { p.position_m.z() = 0.013; }),
              HasSubstr("nothing of the mesh lies between the jaws"));
}

TEST(TaughtPickPoints, AbsentWidthsAreMeasured) {
  const TestFolder folder;
  PickPoint point = across_the_box();
  point.width_m = 0;
  EXPECT_NEAR(only(box_with(folder, point).value(), false, false).front().width_m, 0.040, 1e-6);
  PickPoint cup;
  cup.name = "face";
  cup.position_m = {0.01, 0, 0.01};
  cup.gripper = "suction";
  EXPECT_NEAR(only(box_with(folder, cup).value(), false, true).front().width_m, 0.040, 0.0021);
}

TEST(TaughtPickPoints, CupsMustTouchAFlatPlaceSquarely) {
  const auto cup = [](PickPoint& p) {
    p.gripper = "suction";
    p.position_m.z() = 0.010;
  };
  EXPECT_THAT(fault_with([&](PickPoint& p) {
                cup(p);
                p.position_m.z() = 0.014;
              }),
              HasSubstr("the surface is 4.0 mm away, at (10, 0, 10)"));
  EXPECT_THAT(fault_with([&](PickPoint& p) {
                cup(p);
                p.approach = Vector3d::UnitX();
              }),
              HasSubstr("square to the surface for a cup to seal; at position_mm (10, 0, 10) that "
                        "is (0, 0, -1)"));
  EXPECT_THAT(fault_with([&](PickPoint& p) {
                cup(p);
                p.position_m.x() = 0.029;
              }),
              HasSubstr("too small or too curved for a cup"));
}

}  // namespace
}  // namespace graspd::parts
