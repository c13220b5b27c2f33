#include <gmock/gmock.h>

#include "block_scene.hpp"
#include "graspd/perception/planner.hpp"
#include "graspd/simulation/bin_mesh.hpp"
#include "graspd/simulation/kinect_v2.hpp"
#include "graspd/simulation/scene.hpp"

// The displacement check on frames of a simulated Kinect v2: what stands, what was picked, what
// moved, and what only then came to light. Each frame has noise of its own.
namespace graspd::perception {
namespace {

using Eigen::Vector3d;
using ::testing::HasSubstr;

const Vector3d kBin_m(0.30, 0.24, 0.12);
const Vector3d kBlock_m(0.06, 0.03, 0.02);

class StandingObjects : public ::testing::Test {
 protected:
  StandingObjects() {
    parameters_.preprocess.wall_bow_m = sensor_.wall_bow_m;
    request_.T_base_camera = simulation::camera_over_bin(0.75, 0);
    request_.bin = Bin{Eigen::Isometry3d::Identity(), kBin_m, 0.005};
    request_.parts = {{"block", 0}};
  }

  static Eigen::Isometry3d at(double x_m, double y_m, double z_m = kBlock_m.z() / 2,
                              double turn_rad = 0.3) {
    return Eigen::Translation3d(x_m, y_m, z_m) * Eigen::AngleAxisd(turn_rad, Vector3d::UnitZ());
  }
  DepthFrame frame_of(const std::vector<Eigen::Isometry3d>& blocks) {
    const Eigen::Isometry3d T_camera_bin = request_.T_base_camera.inverse();
    std::vector<simulation::SceneObject> scene{{&bin_, T_camera_bin}};
    for (const auto& T_bin_block : blocks) {
      scene.push_back({&catalogue_.parts()[0].mesh, T_camera_bin * T_bin_block});
    }
    const simulation::Walls walls{T_camera_bin, kBin_m};
    return simulation::observe(scene, sensor_, ++seed_, &walls);
  }
  PlanAnswer plan_of(const std::vector<Eigen::Isometry3d>& blocks) {
    return plan(frame_of(blocks), request_, catalogue_, parameters_).value();
  }
  /// Plans the blocks, and remembers that as the last plan, of which `picked` was taken.
  PlanAnswer remember(const std::vector<Eigen::Isometry3d>& blocks,
                      std::optional<std::size_t> picked = {}) {
    const PlanAnswer answer = plan_of(blocks);
    LastPlan& last = request_.last_plan.emplace();
    for (const Object& object : answer.objects) {
      last.objects.push_back({object.id, object.part_id, object.T_base_part,
                              object.p_base_segment_centroid_m, object.score,
                              object.visible_fraction});
    }
    if (picked) last.picked_object_id = id_at(answer, blocks[*picked]);
    return answer;
  }
  static std::uint32_t id_at(const PlanAnswer& answer, const Eigen::Isometry3d& T_bin_block) {
    for (const Object& object : answer.objects) {
      const Vector3d error_m = object.T_base_part.translation() - T_bin_block.translation();
      if (error_m.norm() < 0.005) return object.id;
    }
    ADD_FAILURE() << "the block at " << T_bin_block.translation().transpose() << " was not found";
    return 0;
  }
  static std::vector<std::uint32_t> ids_of(const PlanAnswer& answer) {
    std::vector<std::uint32_t> ids;
    for (const Object& object : answer.objects) ids.push_back(object.id);
    return ids;
  }

  parts::Catalogue catalogue_{
      {testing::block_part("block", kBlock_m), [] {
         parts::Part other = testing::block_part("other", {0.05, 0.04, 0.03});
         other.bop_obj_id = 2;
         return other;
       }()}};
  parts::Mesh bin_ = simulation::bin_mesh(kBin_m, 0.005);
  simulation::KinectV2Parameters sensor_;
  Parameters parameters_;
  PlanRequest request_;
  std::uint64_t seed_ = 0;
  std::vector<Eigen::Isometry3d> blocks_{at(-0.08, -0.05), at(0.0, -0.05), at(0.08, -0.05, 0.01, 1),
                                         at(-0.06, 0.05, 0.01, 1.5), at(0.05, 0.05)};
};

TEST_F(StandingObjects, WhatNobodyTouchedStands) {
  const PlanAnswer first = remember(blocks_);
  ASSERT_EQ(first.objects.size(), blocks_.size());
  for (int frame = 0; frame < 5; ++frame) {
    const PlanAnswer answer = plan_of(blocks_);
    EXPECT_EQ(answer.outcome, Outcome::kUnchanged) << answer.reason;
    EXPECT_EQ(ids_of(answer), ids_of(first));
    for (std::size_t i = 0; i < first.objects.size(); ++i) {
      EXPECT_GT(first.objects[i].score, 0);
      EXPECT_EQ(answer.objects.at(i).score, first.objects[i].score) << "as probable as before";
    }
    EXPECT_FALSE(answer.grasps.empty());
    EXPECT_TRUE(answer.fill_level);
    EXPECT_EQ(answer.funnel.segments_n, 0U) << "nothing was segmented";
  }
}

TEST_F(StandingObjects, ThePickedOneIsLeftOut) {
  const PlanAnswer first = remember(blocks_, 1);
  blocks_.erase(blocks_.begin() + 1);
  const PlanAnswer answer = plan_of(blocks_);
  EXPECT_EQ(answer.outcome, Outcome::kUnchanged) << answer.reason;
  EXPECT_EQ(answer.objects.size(), blocks_.size());
  for (const Object& object : answer.objects) {
    EXPECT_NE(object.id, *request_.last_plan->picked_object_id);
  }
}

TEST_F(StandingObjects, APickedOneThatIsStillThereIsPlannedAgain) {
  remember(blocks_, 1);
  const PlanAnswer answer = plan_of(blocks_);
  EXPECT_EQ(answer.outcome, Outcome::kPlanned);
  EXPECT_EQ(answer.objects.size(), blocks_.size());
}

TEST_F(StandingObjects, OneThatMovedIsEnoughToPlanAnew) {
  const std::vector<Eigen::Isometry3d> before = blocks_;
  for (std::size_t moved = 0; moved < blocks_.size(); ++moved) {
    for (const Vector3d& way_m : {Vector3d(0.01, 0, 0), Vector3d(0, -0.01, 0),
                                  Vector3d(-0.008, 0.008, 0), Vector3d(0, 0, 0.012)}) {
      request_.last_plan.reset();
      remember(before);
      blocks_ = before;
      blocks_[moved].pretranslate(way_m);
      EXPECT_EQ(plan_of(blocks_).outcome, Outcome::kPlanned)
          << "block " << moved << " by " << way_m.transpose();
    }
  }
}

TEST_F(StandingObjects, OneThatTurnedIsEnoughToPlanAnew) {
  remember(blocks_);
  blocks_[2].rotate(Eigen::AngleAxisd(0.5, Vector3d::UnitZ()));
  EXPECT_EQ(plan_of(blocks_).outcome, Outcome::kPlanned);
}

TEST_F(StandingObjects, OneThatWasTakenAwayUnaskedIsEnoughToPlanAnew) {
  remember(blocks_, 1);
  blocks_.erase(blocks_.begin() + 3);
  blocks_.erase(blocks_.begin() + 1);
  EXPECT_EQ(plan_of(blocks_).outcome, Outcome::kPlanned);
}

TEST_F(StandingObjects, WhatCameToLightWaitsForTheNextFullPlan) {
  // Under the block that is picked lies another, which is hardly seen before.
  blocks_.push_back(at(0.05, 0.05, 0.03));
  remember(blocks_, blocks_.size() - 1);
  blocks_.pop_back();
  const PlanAnswer unchanged = plan_of(blocks_);
  EXPECT_EQ(unchanged.outcome, Outcome::kUnchanged) << unchanged.reason;
  EXPECT_EQ(unchanged.objects.size(), blocks_.size() - 1);
  request_.last_plan.reset();
  EXPECT_EQ(plan_of(blocks_).objects.size(), blocks_.size());
}

TEST_F(StandingObjects, WhereNothingThatStandsCanBeGraspedTheRestIsLookedFor) {
  remember(blocks_, 0);
  // Of the last plan, one is left, and the gripper has no room at the wall beside it.
  request_.last_plan->objects.resize(1);
  request_.last_plan->picked_object_id.reset();
  request_.gripper.max_opening_m = 0.02;
  const PlanAnswer answer = plan_of(blocks_);
  EXPECT_EQ(answer.outcome, Outcome::kAllInCollision);
  EXPECT_EQ(answer.objects.size(), blocks_.size()) << "all were looked for";
}

TEST_F(StandingObjects, TheSegmentsCentroidsCanDecideInstead) {
  parameters_.displacement.check = DisplacementCheck::kCentroids;
  remember(blocks_, 1);
  blocks_.erase(blocks_.begin() + 1);
  const PlanAnswer answer = plan_of(blocks_);
  EXPECT_EQ(answer.outcome, Outcome::kUnchanged) << answer.reason;
  EXPECT_GT(answer.funnel.segments_n, 0U);
  blocks_[0].pretranslate(Vector3d(0.01, 0, 0));
  EXPECT_EQ(plan_of(blocks_).outcome, Outcome::kPlanned);
}

TEST_F(StandingObjects, ALastPlanOfAnotherPartIsNamedAndLeftOut) {
  remember(blocks_);
  for (const char* part : {"other", "no part of the catalogue"}) {
    request_.last_plan->objects[1].part_id = part;
    const PlanAnswer answer = plan_of(blocks_);
    EXPECT_EQ(answer.outcome, Outcome::kPlanned) << "planned anew, not refused";
    EXPECT_EQ(answer.objects.size(), blocks_.size());
    ASSERT_EQ(answer.warnings.size(), 1U);
    EXPECT_THAT(answer.warnings[0], HasSubstr(fmt::format("is of part '{}', which is not", part)));
  }
}

TEST_F(StandingObjects, AnEmptyLastPlanIsNone) {
  request_.last_plan.emplace();
  EXPECT_EQ(plan_of(blocks_).outcome, Outcome::kPlanned);
}

TEST_F(StandingObjects, ALastPlanOfAThousandEntriesIsRefusedByName) {
  request_.last_plan.emplace();
  for (std::uint32_t id = 0; id < 1000; ++id) {
    request_.last_plan->objects.emplace_back();
    request_.last_plan->objects.back().id = id;
  }
  const auto answer = plan(frame_of(blocks_), request_, catalogue_, parameters_);
  ASSERT_FALSE(answer);
  EXPECT_EQ(answer.error().code, Code::kInvalidArgument);
  EXPECT_THAT(answer.error().message,
              HasSubstr("last_plan.objects: 1000 objects; at most 100 are taken"));
}

TEST_F(StandingObjects, AHundredEntriesAreBoundedWork) {
  // All at one place, where each is in the way of the others' grasps: what is there is found anew.
  remember(blocks_);
  const LastObject one = request_.last_plan->objects[0];
  request_.last_plan->objects.assign(kMaxLastObjects, one);
  for (std::uint32_t id = 0; id < kMaxLastObjects; ++id) {
    request_.last_plan->objects[id].id = id + 1;
  }
  const PlanAnswer answer = plan_of(blocks_);
  EXPECT_EQ(answer.outcome, Outcome::kPlanned);
  EXPECT_EQ(answer.objects.size(), blocks_.size());
  EXPECT_LE(answer.grasps.size(), static_cast<std::size_t>(parameters_.grasp.max_grasps_n));
}

}  // namespace
}  // namespace graspd::perception
