/// What a gripper may run into: blocks on a floor under a camera that looks straight down.
#include "graspd/perception/collision.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>

#include "block_pile.hpp"
#include "fcl_twin.hpp"
#include "random_pose.hpp"

namespace graspd::perception {
namespace {

using Eigen::Vector3d;
using testing::BlockPile;
using ::testing::HasSubstr;

constexpr double kOpening_m = 0.035;  // 25 mm of part, 5 mm on each side
constexpr Check kGripperChecks[] = {Check::kGripperCloud, Check::kGripperParts, Check::kGripperBin};

/// Straight down, the tips 4 mm above the underside of the block.
Eigen::Isometry3d above(const PlacedPart& part) {
  Eigen::Isometry3d T = part.T_floor_part;
  T.translate(Vector3d(0, 0, -0.0085));
  T.rotate(Eigen::AngleAxisd(M_PI / 2, Vector3d::UnitZ()));  // x across the block
  T.rotate(Eigen::AngleAxisd(M_PI, Vector3d::UnitX()));
  return T;
}

class Collision : public ::testing::Test {
 protected:
  CollisionScene scene_with(const std::optional<Bin>& bin) {
    CollisionScene scene(pile_.scene, pile_.parts, bin, gripper_, parameters_);
    scene.set_target(0);
    return scene;
  }
  Verdicts check(const Eigen::Isometry3d& T_floor_grasp) {
    Verdicts verdicts;
    scene_with(pile_.bin).check_all(T_floor_grasp, kOpening_m, verdicts);
    return verdicts;
  }
  CheckState state(Check check_name, const Eigen::Isometry3d& T_floor_grasp) {
    return of(check(T_floor_grasp), check_name).state;
  }
  void add(const Eigen::Isometry3d& T_floor_part) { pile_.parts.push_back({&bar_, T_floor_part}); }

  const parts::Part bar_ = testing::block_part("bar", {0.08, 0.025, 0.025});
  BlockPile pile_;
  Gripper gripper_;
  CollisionParameters parameters_;
};

TEST_F(Collision, JawsBesideALonePartPassEverywhereUnderTheCamera) {
  for (const double x_m : {-0.16, -0.08, 0.0, 0.12}) {
    for (const double y_m : {-0.11, 0.0, 0.07}) {
      for (const double yaw : {0.0, 0.5, 1.2, 2.2}) {
        pile_.parts.clear();
        add(BlockPile::at(x_m, y_m, 0.0125, yaw));
        pile_.look();
        const Verdicts verdicts = check(above(pile_.parts[0]));
        for (const auto& [check_name, name] : EnumNames<Check>::values) {
          if (check_name == Check::kOpening) continue;
          EXPECT_EQ(of(verdicts, check_name).state, CheckState::kPassed)
              << name << " at " << x_m << ", " << y_m << ", yaw " << yaw;
        }
      }
    }
  }
}

TEST_F(Collision, AJawInANeighbourFailsWhetherTheNeighbourIsRecognisedOrNot) {
  add(BlockPile::at(0.02, 0, 0.0125));
  const Eigen::Isometry3d T_neighbour = BlockPile::at(0.02, 0.035, 0.0125);  // 10 mm beside
  pile_.others = {{T_neighbour, Vector3d(0.08, 0.025, 0.025)}};
  pile_.look();
  const Eigen::Isometry3d T = above(pile_.parts[0]);
  EXPECT_EQ(of(check(T), Check::kGripperCloud).state, CheckState::kFailed);
  EXPECT_EQ(of(check(T), Check::kGripperCloud).culprit, "jaw");
  EXPECT_EQ(of(check(T), Check::kGripperParts).state, CheckState::kPassed);

  pile_.others.clear();
  add(T_neighbour);
  pile_.look();
  const Verdict parts = of(check(T), Check::kGripperParts);
  EXPECT_EQ(parts.state, CheckState::kFailed);
  EXPECT_EQ(parts.other, 1U);
  EXPECT_EQ(of(check(T), Check::kGripperCloud).state, CheckState::kFailed);
}

TEST_F(Collision, OnlyFloorAndRecognisedPartsMayReadTooNear) {
  add(BlockPile::at(0.02, 0, 0.0125));
  const Eigen::Isometry3d T = above(pile_.parts[0]);  // the tips 4 mm above the floor
  pile_.look([](DepthFrame& frame) {
    for (std::uint16_t& depth : frame.depth) depth = depth == 0 ? 0 : std::uint16_t(depth - 5);
  });
  EXPECT_EQ(state(Check::kGripperCloud, T), CheckState::kPassed) << "a floor that reads too near";

  const Vector3d plate_m(0.08, 0.025, 0.009);
  pile_.others = {{BlockPile::at(0.02, 0.035, plate_m.z() / 2), plate_m}};
  pile_.look();
  EXPECT_EQ(state(Check::kGripperCloud, T), CheckState::kFailed) << "a part that was not found";
  const parts::Part plate = testing::block_part("plate", plate_m);
  pile_.parts.push_back({&plate, pile_.others[0].T_camera_block});
  EXPECT_EQ(state(Check::kGripperCloud, T), CheckState::kPassed) << "the same, found";
  EXPECT_EQ(state(Check::kGripperParts, T), CheckState::kFailed);
}

TEST_F(Collision, AnUnrecognisedPartMayReachBeyondItsReadings) {
  add(BlockPile::at(0.02, 0, 0.0125));
  const Eigen::Isometry3d T = above(pile_.parts[0]);
  const auto beside = [](double gap_m) {  // the jaw ends 25.5 mm from the part's middle
    return BlockPile::at(0.02, 0.0255 + gap_m + 0.0125, 0.0125);
  };
  pile_.others = {{beside(0.008), Vector3d(0.08, 0.025, 0.025)}};
  pile_.look();
  EXPECT_EQ(state(Check::kGripperCloud, T), CheckState::kPassed) << "8 mm away";
  pile_.others = {{beside(0.0022), Vector3d(0.08, 0.025, 0.025)}};
  pile_.look();
  EXPECT_EQ(state(Check::kGripperCloud, T), CheckState::kFailed) << "2.2 mm away";
  pile_.others.clear();
  add(beside(0.0022));
  pile_.look();
  EXPECT_EQ(state(Check::kGripperCloud, T), CheckState::kPassed) << "2.2 mm away, and found";
  EXPECT_EQ(state(Check::kGripperParts, T), CheckState::kPassed);
}

TEST_F(Collision, AJawInTheShadowOfATallNeighbourFails) {
  // Under the camera's foot the block's far side is hidden: at x = 0.125 it is 100 mm high, and
  // hides the floor up to x = 0.125 · 750 / 650 = 0.144.
  const testing::Block tall{BlockPile::at(0.1, 0, 0.05), Vector3d(0.05, 0.1, 0.1)};
  add(BlockPile::at(0.158, 0, 0.0125, M_PI / 2));  // its near jaw stands from 0.1325 to 0.1405
  pile_.look();
  const Eigen::Isometry3d T = above(pile_.parts[0]);
  EXPECT_EQ(state(Check::kGripperCloud, T), CheckState::kPassed) << "without the neighbour";
  pile_.others = {tall};
  pile_.look();
  EXPECT_EQ(state(Check::kGripperCloud, T), CheckState::kFailed);
}

TEST_F(Collision, SpaceThatWasNotSeenCountsAsOccupied) {
  add(BlockPile::at(0, 0, 0.0125));
  const auto without_readings = [&](int half_px) {
    pile_.look([&](DepthFrame& frame) {
      // Around where the jaw at y = −21 mm meets the floor: 10 pixels below the centre.
      for (int v = 205 + 11 - half_px; v <= 205 + 11 + half_px; ++v) {
        for (int u = 255 - half_px; u <= 255 + half_px; ++u) {
          frame.depth[static_cast<std::size_t>(v) * 512 + static_cast<std::size_t>(u)] = 0;
        }
      }
    });
    return state(Check::kGripperCloud, above(pile_.parts[0]));
  };
  EXPECT_EQ(without_readings(1), CheckState::kPassed) << "as deep as what is seen around it";
  EXPECT_EQ(without_readings(10), CheckState::kFailed);
}

TEST_F(Collision, WhatIsBeyondTheImageCountsAsOccupiedWherePartsMayLie) {
  pile_.bin.inner_size_m = Vector3d(2, 1, 0.15);
  add(BlockPile::at(0.515, 0, 0.0125));  // the image ends at 257 px · 750 / 365.5 = 0.525
  pile_.look();
  EXPECT_EQ(state(Check::kGripperCloud, above(pile_.parts[0])), CheckState::kFailed);
}

TEST_F(Collision, FarAboveNothingIsInTheWay) {
  std::mt19937 random(1);
  for (int i = 0; i < 12; ++i) {
    Eigen::Isometry3d T = testing::random_pose(random, 0.12);
    T.translation().z() = 0.03;
    add(T);
  }
  pile_.look();
  for (const double yaw : {0.0, 0.7, 2.0}) {
    Eigen::Isometry3d T = BlockPile::at(0, 0, 0.25, yaw);
    T.rotate(Eigen::AngleAxisd(M_PI, Vector3d::UnitX()));
    const Verdicts verdicts = check(T);
    for (const Check name : kGripperChecks) {
      EXPECT_EQ(of(verdicts, name).state, CheckState::kPassed) << name_of(name);
    }
  }
}

TEST_F(Collision, LoweredIntoMatterItFailsAndGoesOnFailing) {
  add(BlockPile::at(0, 0, 0.0125));
  add(BlockPile::at(0.1, 0, 0.0125));
  pile_.look();
  for (const Check name : kGripperChecks) {
    bool has_failed = false;
    for (int step = 0; step < 125; ++step) {
      const double z_m = 0.2 - 0.002 * step;
      Eigen::Isometry3d T = BlockPile::at(0.1, 0.0175, z_m, M_PI / 2);  // a jaw over the neighbour
      T.rotate(Eigen::AngleAxisd(M_PI, Vector3d::UnitX()));
      const bool fails = state(name, T) == CheckState::kFailed;
      EXPECT_TRUE(fails || !has_failed) << name_of(name) << " at " << z_m;
      has_failed |= fails;
    }
    EXPECT_TRUE(has_failed) << name_of(name);
  }
}

class RandomPile : public Collision {
 protected:
  void drop(std::mt19937& random) {
    pile_.parts.clear();
    for (int i = 0; i < 8; ++i) {
      Eigen::Isometry3d T = testing::random_pose(random, 0.16);
      T.translation().z() = 0.02 + 0.004 * i;
      add(T);
    }
    pile_.look();
  }
  static Eigen::Isometry3d random_grasp(std::mt19937& random) {
    std::uniform_real_distribution<double> angle(-0.6, 0.6), turn(0, M_PI), height(0.005, 0.08);
    Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
    T.translate(testing::random_point(random, 0.3F).cast<double>());
    T.translation().z() = height(random);
    T.rotate(Eigen::AngleAxisd(turn(random), Vector3d::UnitZ()) *
             Eigen::AngleAxisd(M_PI + angle(random), Vector3d::UnitX()));
    return T;
  }
};

TEST_F(RandomPile, TheModelCheckAgreesWithFcl) {
  std::mt19937 random(21);
  int hits_n = 0;
  for (int pile = 0; pile < 10; ++pile) {
    drop(random);
    const CollisionScene scene = scene_with(pile_.bin);
    testing::FclTwin twin(pile_.parts);
    const auto expected = [&](const Eigen::Isometry3d& T, double margin_m) {
      return twin.meets(0, T, {gripper_, kOpening_m}, margin_m);
    };
    for (int i = 0; i < 100; ++i) {
      const Eigen::Isometry3d T = random_grasp(random);
      const bool hit = scene.gripper_parts(T, {gripper_, kOpening_m}).failed();
      hits_n += hit;
      if (hit == expected(T, parameters_.margin_m)) continue;
      // In float, within a hundredth of a millimetre of a surface, it may go either way.
      EXPECT_NE(expected(T, parameters_.margin_m + 1e-5), expected(T, parameters_.margin_m - 1e-5));
    }
  }
  EXPECT_GT(hits_n, 200);
  EXPECT_LT(hits_n, 950);
}

TEST_F(RandomPile, AWiderGripperNeverPassesWhereANarrowerOneFails) {
  std::mt19937 random(8);
  int passed_n = 0;
  for (int pile = 0; pile < 6; ++pile) {
    drop(random);
    for (int i = 0; i < 40; ++i) {
      const Eigen::Isometry3d T = random_grasp(random);
      Verdicts before{};
      for (const double by : {0.5, 0.7, 1.0, 1.5, 3.0}) {
        gripper_ = {};
        gripper_.jaw_size_m.head<2>() *= by;
        gripper_.palm_size_m *= by;
        gripper_.standoff_m *= by;
        const Verdicts verdicts = check(T);
        for (const Check name : kGripperChecks) {
          if (of(before, name).failed()) {
            EXPECT_TRUE(of(verdicts, name).failed()) << name_of(name) << " by " << by;
          }
          passed_n += !of(verdicts, name).failed();
        }
        before = verdicts;
      }
    }
  }
  EXPECT_GT(passed_n, 300);
}

TEST_F(RandomPile, TurningTheWholeSceneAboutTheVerticalChangesNothing) {
  std::mt19937 random(13);
  pile_.bin.inner_size_m = Vector3d(0.5, 0.5, 0.15);  // a quarter turn of it is itself
  for (int i = 0; i < 10; ++i) {
    drop(random);
    for (int k = 0; k < 20; ++k) {
      const Eigen::Isometry3d T = random_grasp(random);
      const Verdicts before = check(T);
      const Eigen::Isometry3d turn = BlockPile::at(0, 0, 0, M_PI / 2);
      const BlockPile unturned = pile_;
      for (PlacedPart& part : pile_.parts) part.T_floor_part = turn * part.T_floor_part;
      pile_.scene.T_camera_floor = pile_.scene.T_camera_floor * turn.inverse();
      const Verdicts after = check(turn * T);
      for (const auto& [name, text] : EnumNames<Check>::values) {
        EXPECT_EQ(of(before, name).state, of(after, name).state) << text;
      }
      pile_ = unturned;
    }
  }
}

TEST_F(Collision, EachCheckHasItsSwitchAndSaysThatItIsOff) {
  add(BlockPile::at(0, 0, 0.0125));
  add(BlockPile::at(0, 0.01, 0.0375));  // on it, and in the way of everything
  pile_.look();
  pile_.bin.inner_size_m = Vector3d(0.04, 0.04, 0.15);
  const Eigen::Isometry3d T = above(pile_.parts[0]);
  const std::pair<Check, bool CollisionParameters::*> switches[] = {
      {Check::kGripperCloud, &CollisionParameters::gripper_cloud},
      {Check::kGripperParts, &CollisionParameters::gripper_parts},
      {Check::kGripperBin, &CollisionParameters::gripper_bin},
      {Check::kHeldPart, &CollisionParameters::held_part}};
  for (const auto& [off, its_switch] : switches) {
    parameters_ = {};
    parameters_.*its_switch = false;
    const CollisionScene scene = scene_with(pile_.bin);
    const Verdicts verdicts = check(T);
    for (const auto& [name, member] : switches) {
      const Verdict& verdict = of(verdicts, name);
      EXPECT_EQ(verdict.state, name == off ? CheckState::kNotRun : CheckState::kFailed)
          << name_of(name) << " with " << name_of(off) << " off";
      const std::uint32_t ids[] = {7, 8};
      EXPECT_THAT(scene.reason(name, verdict, ids),
                  HasSubstr(name == off ? "switched off" : " the "));
    }
  }
}

TEST_F(Collision, WhatACheckLacksItSays) {
  add(BlockPile::at(0, 0, 0.0125));
  const Eigen::Isometry3d T = above(pile_.parts[0]);  // and nothing was looked at
  const CollisionScene scene = scene_with(std::nullopt);
  Verdicts verdicts;
  scene.check_all(T, kOpening_m, verdicts);
  const auto reason = [&](Check name) { return scene.reason(name, of(verdicts, name), {}); };
  EXPECT_EQ(of(verdicts, Check::kGripperBin).state, CheckState::kNotRun);
  EXPECT_EQ(reason(Check::kGripperBin), "no bin was given");
  EXPECT_EQ(of(verdicts, Check::kGripperCloud).state, CheckState::kNotRun);
  EXPECT_EQ(reason(Check::kGripperCloud), "there is no depth image to check against");
  EXPECT_EQ(reason(Check::kGripperParts), "") << "passed";
}

TEST_F(Collision, WallsEndAtTheRimAndFloorsDoNot) {
  add(BlockPile::at(0, 0, 0.0125));
  pile_.look();
  const auto at = [&](double x_m, double z_m) {
    Eigen::Isometry3d T = BlockPile::at(x_m, 0, z_m);
    T.rotate(Eigen::AngleAxisd(M_PI, Vector3d::UnitX()));
    return state(Check::kGripperBin, T);
  };
  EXPECT_EQ(at(0, 0.001), CheckState::kPassed);
  EXPECT_EQ(at(0, -0.001), CheckState::kFailed) << "tips in the floor";
  EXPECT_EQ(at(0.19, 0.01), CheckState::kPassed);
  EXPECT_EQ(at(0.21, 0.01), CheckState::kFailed) << "the palm, 50 mm to each side, in the wall";
  EXPECT_EQ(at(0.21, 0.11), CheckState::kPassed) << "the palm above the rim";
  EXPECT_EQ(at(0.23, 0.11), CheckState::kFailed) << "a jaw in the wall";
  EXPECT_EQ(at(0.253, 0.11), CheckState::kFailed) << "the wall between the jaws";
  EXPECT_EQ(at(0.25, 0.16), CheckState::kPassed) << "all above the rim";
  EXPECT_EQ(at(0.32, 0.01), CheckState::kPassed) << "beside the bin";
}

TEST_F(Collision, JawsMustNotCutIntoThePartItself) {
  add(BlockPile::at(0, 0, 0.0125));
  pile_.look();
  Eigen::Isometry3d T = above(pile_.parts[0]);
  T.translate(Vector3d(0.008, 0, 0));  // a jaw 3 mm into the part
  const Verdict parts = of(check(T), Check::kGripperParts);
  EXPECT_EQ(parts.state, CheckState::kFailed);
  EXPECT_EQ(parts.other, 0U);
  EXPECT_TRUE(parts.depends_on_opening);
}

TEST_F(Collision, RoomIsByHowMuchWiderTheGripperCouldBe) {
  parameters_.gripper_cloud = false;
  for (const auto& [gap_m, room_m] : std::map<double, double>{
           {0.0005, 0}, {0.003, 0.002}, {0.005, 0.004}, {0.007, 0.006}, {0.02, 0.006}}) {
    pile_.parts.clear();
    add(BlockPile::at(0, 0, 0.0125));
    const double jaw_m = kOpening_m / 2 + gripper_.jaw_size_m.x() + parameters_.margin_m;
    add(BlockPile::at(0, jaw_m + gap_m + 0.0125, 0.0125));
    pile_.look();
    const Eigen::Isometry3d T = above(pile_.parts[0]);
    EXPECT_EQ(of(check(T), Check::kGripperParts).state, CheckState::kPassed);
    EXPECT_EQ(scene_with(pile_.bin).room_m(T, kOpening_m), room_m) << "gap of " << gap_m;
  }
}

TEST_F(Collision, ASuctionCupSitsOnThePart) {
  gripper_.kind = GripperKind::kSuction;
  gripper_.cup_diameter_m = 0.02;
  add(BlockPile::at(0, 0, 0.0125));
  pile_.look();
  Eigen::Isometry3d T = BlockPile::at(0, 0, 0.025);
  T.rotate(Eigen::AngleAxisd(M_PI, Vector3d::UnitX()));
  const Verdicts verdicts = check(T);
  for (const Check name : kGripperChecks) {
    EXPECT_EQ(of(verdicts, name).state, CheckState::kPassed) << name_of(name);
  }
  T.translation().z() = 0.015;
  EXPECT_EQ(state(Check::kGripperParts, T), CheckState::kFailed) << "10 mm into the part";
}

}  // namespace
}  // namespace graspd::perception
