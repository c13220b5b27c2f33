/// What must hold of every ranking, on random piles.
#include "ranking.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "graspd/perception/principal_axis.hpp"
#include "pile_objects.hpp"
#include "random_pile.hpp"

namespace graspd::perception {
namespace {

using Eigen::Vector3d;
using testing::long_bar;

class Ranking : public ::testing::Test {
 protected:
  /// 20 objects of two kinds, two or three grasps each, in random order.
  void make_pile(std::mt19937& random) {
    const auto pile = testing::random_pile(long_bar(), 20, random);
    objects_.assign(pile.size(), {});
    for (std::size_t i = 0; i < pile.size(); ++i) {
      objects_[i].id = static_cast<std::uint32_t>(100 + 7 * i);
      objects_[i].part_id = i % 2 == 0 ? "even" : "odd";
      objects_[i].T_base_part = pile[i].T_floor_part;
      objects_[i].score = 1;
      objects_[i].visible_fraction = std::uniform_real_distribution<double>(0.4, 1)(random);
    }
    describe_pile(pile, parameters_, objects_);
    grasps_.clear();
    for (const Object& object : objects_) {
      for (std::uint32_t k = 0; k < 2 + object.id % 2; ++k) {
        Grasp grasp;
        grasp.object_id = object.id;
        grasp.pick_point = std::to_string(k);
        grasp.T_base_grasp = object.T_base_part;
        grasp.T_base_grasp.translate(Vector3d(0.03 * k, 0, 0));
        grasps_.push_back(grasp);
      }
    }
  }
  const Object& object_of(const Grasp& grasp) const {
    return *std::ranges::find(objects_, grasp.object_id, &Object::id);
  }
  std::vector<Grasp> ranked() const {
    std::vector<Grasp> grasps = grasps_;
    rank_grasps(request_, parameters_, objects_, grasps);
    return grasps;
  }
  static std::vector<std::string> names(const std::vector<Grasp>& grasps) {
    std::vector<std::string> names;
    for (const Grasp& grasp : grasps) {
      names.push_back(std::to_string(grasp.object_id) + "/" + grasp.pick_point);
    }
    return names;
  }

  Parameters parameters_ = [] {
    Parameters parameters;
    parameters.grs.p_system = PSystem::kSupport;
    return parameters;
  }();
  PlanRequest request_;
  std::vector<Object> objects_;
  std::vector<Grasp> grasps_;
};

TEST_F(Ranking, NothingIsOfferedBeforeWhatRestsOnItWhateverTheStrategy) {
  std::mt19937 random(1);
  std::size_t supports_n = 0;
  for (const Strategy strategy : {Strategy::kGrs, Strategy::kHighest, Strategy::kMostVisible,
                                  Strategy::kNearest, Strategy::kPreferredApproach}) {
    request_.options.strategy = strategy;
    request_.options.strategy_vector_base_m = Vector3d(0.1, 0, -1);
    request_.parts = {{"even", 1}, {"odd", 0}};
    for (int round = 0; round < 5; ++round) {
      make_pile(random);
      std::set<std::uint32_t> offered;
      bool waits = false;
      for (const Grasp& grasp : ranked()) {
        const Object& object = object_of(grasp);
        for (const std::uint32_t upper : object.supports_ids) {
          EXPECT_TRUE(offered.contains(upper)) << grasp.object_id << " before " << upper;
          ++supports_n;
        }
        const bool is_free = object.supports_ids.empty() && object.entangled_ids.empty() &&
                             object.double_pick_ids.empty();
        EXPECT_FALSE(waits && is_free) << grasp.object_id << " is free and comes late";
        waits |= !is_free;
        offered.insert(grasp.object_id);
      }
    }
  }
  EXPECT_GT(supports_n, 500U);
}

TEST_F(Ranking, IsTheSameWhateverTheOrderItIsGiven) {
  std::mt19937 random(2);
  make_pile(random);
  const auto expected = names(ranked());
  for (int round = 0; round < 20; ++round) {
    // Between objects; an object's own grasps come best first.
    std::shuffle(grasps_.begin(), grasps_.end(), random);
    std::ranges::stable_sort(grasps_, {}, &Grasp::pick_point);
    EXPECT_EQ(names(ranked()), expected);
  }
}

TEST_F(Ranking, EqualObjectsAreOfferedByTheirIds) {
  std::mt19937 random(3);
  make_pile(random);
  for (Object& object : objects_) {
    Object same;
    same.id = object.id;
    object = same;
  }
  std::shuffle(grasps_.begin(), grasps_.end(), random);
  std::vector<std::uint32_t> ids;
  for (const Grasp& grasp : ranked()) ids.push_back(grasp.object_id);
  EXPECT_TRUE(std::is_sorted(ids.begin(), ids.begin() + 20));
}

TEST_F(Ranking, OfALayerEveryObjectHasItsTurnBeforeAnyHasItsSecond) {
  std::mt19937 random(4);
  parameters_.grs.p_system = PSystem::kCount;  // one layer
  make_pile(random);
  const auto grasps = ranked();
  std::set<std::uint32_t> first;
  for (std::size_t i = 0; i < objects_.size(); ++i) first.insert(grasps[i].object_id);
  EXPECT_EQ(first.size(), objects_.size());
  for (std::size_t i = 0; i < objects_.size(); ++i) EXPECT_EQ(grasps[i].pick_point, "0");
}

TEST_F(Ranking, OfALayerTheRoomiestComesFirst) {
  std::mt19937 random(9);
  std::set<double> rooms_m;
  for (int pile = 0; pile < 10; ++pile) {
    make_pile(random);
    for (Grasp& grasp : grasps_) grasp.room_m = 0.002 * std::uniform_int_distribution(0, 3)(random);
    std::set<std::uint32_t> seen;
    double last_m = 0.006;
    for (const Grasp& grasp : ranked()) {
      const Object& object = object_of(grasp);
      const bool is_free = object.supports_ids.empty() && object.entangled_ids.empty() &&
                           object.double_pick_ids.empty();
      if (!is_free || !seen.insert(grasp.object_id).second) break;
      EXPECT_LE(grasp.room_m, last_m);
      last_m = grasp.room_m;
      rooms_m.insert(last_m);
      for (const Grasp& other : grasps_) {
        if (other.object_id != grasp.object_id) continue;
        EXPECT_LE(other.room_m, grasp.room_m);
      }
    }
  }
  EXPECT_GT(rooms_m.size(), 2U);
}

TEST_F(Ranking, OfALayerTheSureComeBeforeTheDoubtfulAndThePrincipalAxisLast) {
  std::mt19937 random(11);
  make_pile(random);
  for (Object& object : objects_) {
    object.supports_ids.clear();
    object.entangled_ids.clear();
    object.double_pick_ids.clear();
    object.score = object.id % 3 == 0 ? 0.5 : 0.9;
  }
  for (Grasp& grasp : grasps_) {
    if (grasp.pick_point == "0" && grasp.object_id % 2 == 0) grasp.pick_point = kPrincipalAxis;
    grasp.room_m = grasp.pick_point == kPrincipalAxis || grasp.object_id % 3 == 0 ? 0.006 : 0;
  }
  const auto worth = [&](const Grasp& grasp) {
    return std::pair(grasp.pick_point == kPrincipalAxis,
                     object_of(grasp).score < parameters_.grs.sure_score);
  };
  const auto grasps = ranked();
  EXPECT_TRUE(std::ranges::is_sorted(grasps, {}, worth));
  EXPECT_EQ(worth(grasps.front()), std::pair(false, false));
  EXPECT_EQ(worth(grasps.back()), std::pair(true, true));
}

TEST_F(Ranking, RoomDoesNotCountWhereTheOrderIsThePapersOrTheRequests) {
  std::mt19937 random(10);
  make_pile(random);
  const auto order = [&](double room_m) {
    for (Grasp& grasp : grasps_) grasp.room_m = grasp.pick_point == "1" ? room_m : 0;
    return names(ranked());
  };
  EXPECT_NE(order(0.006), order(0));
  request_.options.strategy = Strategy::kHighest;
  EXPECT_EQ(order(0.006), order(0));
  request_.options.strategy = Strategy::kGrs;
  parameters_.grs.p_system = PSystem::kCount;
  EXPECT_EQ(order(0.006), order(0));
}

TEST_F(Ranking, AFailedSpotComesLastAndItsObjectsOtherGraspsJustBefore) {
  std::mt19937 random(5);
  make_pile(random);
  const Grasp best = ranked().front();
  request_.failed_spots = {{best.T_base_grasp.translation(), 0.005, 2, {}}};
  const auto again = ranked();
  const auto own_n = std::ranges::count(grasps_, best.object_id, &Grasp::object_id);
  const auto failed_n = std::ranges::count_if(grasps_, [&](const Grasp& grasp) {
    const Vector3d way_m = grasp.T_base_grasp.translation() - best.T_base_grasp.translation();
    return way_m.norm() <= 0.005;
  });
  ASSERT_EQ(failed_n, 1) << "no other grasp is there by chance";
  EXPECT_EQ(names(again).back(), names({best}).front());
  for (std::size_t i = again.size() - static_cast<std::size_t>(own_n); i < again.size(); ++i) {
    EXPECT_EQ(again[i].object_id, best.object_id);
  }
}

TEST_F(Ranking, HigherPrioritiesComeFirstAmongWhatIsFree) {
  std::mt19937 random(6);
  make_pile(random);
  request_.parts = {{"even", 0}, {"odd", 5}};
  const auto grasps = ranked();
  const auto layer_end = std::ranges::find_if(grasps, [&](const Grasp& grasp) {
    const Object& object = object_of(grasp);
    return !object.supports_ids.empty() || !object.entangled_ids.empty() ||
           !object.double_pick_ids.empty();
  });
  const auto is_even = [&](const Grasp& grasp) { return object_of(grasp).part_id == "even"; };
  const auto first_even = std::find_if(grasps.begin(), layer_end, is_even);
  EXPECT_NE(first_even, grasps.begin());
  EXPECT_TRUE(std::all_of(first_even, layer_end, is_even));
}

TEST_F(Ranking, TheScoreIsWhatTheStrategySortsBy) {
  std::mt19937 random(7);
  parameters_.grs.p_system = PSystem::kCount;
  make_pile(random);
  for (const Strategy strategy :
       {Strategy::kHighest, Strategy::kMostVisible, Strategy::kNearest, Strategy::kGrs}) {
    request_.options.strategy = strategy;
    const auto grasps = ranked();
    for (std::size_t i = 1; i < objects_.size(); ++i) {
      EXPECT_GE(grasps[i - 1].score, grasps[i].score) << name_of(strategy);
    }
  }
}

TEST_F(Ranking, AscendingIsTheEquationAsPrinted) {
  std::mt19937 random(8);
  parameters_.grs.order = GraspOrder::kAscending;
  make_pile(random);
  const auto grasps = ranked();
  for (std::size_t i = 1; i < objects_.size(); ++i) {
    EXPECT_LE(grasps[i - 1].score, grasps[i].score);
  }
}

}  // namespace
}  // namespace graspd::perception
