/// What comes along, or is in the way, when a part is lifted straight up.
#include "graspd/perception/lifting.hpp"

#include <gtest/gtest.h>

#include "block_pile.hpp"
#include "graspd/parts/catalogue.hpp"

namespace graspd::perception {
namespace {

using Eigen::Vector3d;
using testing::BlockPile;

const parts::Part& square_bar() {
  static const parts::Part part = testing::block_part("bar", {0.08, 0.025, 0.025});
  return part;
}

TEST(Lifting, TheUpperOfTwoIsFreeAndTheLowerIsNot) {
  for (const double yaw : {0.0, 0.6, 1.57}) {
    const std::vector<PlacedPart> parts = {{&square_bar(), BlockPile::at(0, 0, 0.0125)},
                                           {&square_bar(), BlockPile::at(0.02, 0, 0.0375, yaw)},
                                           {&square_bar(), BlockPile::at(0.2, 0, 0.0125)}};
    const Lifting lifting(parts, {});
    EXPECT_EQ(lifting.in_the_way(0), 1U);
    EXPECT_FALSE(lifting.in_the_way(1));
    EXPECT_FALSE(lifting.in_the_way(2)) << "far away";
  }
}

TEST(Lifting, PartsSideBySideAreFreeThoughNoiseMovesThem) {
  for (const double yaw : {0.0, 0.3, 0.8, 1.3}) {
    for (const double shift_m : {-0.001, 0.0, 0.001}) {
      const Eigen::Isometry3d T = BlockPile::at(0.003, 0.001, 0.0125, yaw);
      const std::vector<PlacedPart> parts = {
          {&square_bar(), T}, {&square_bar(), T * BlockPile::at(0.01, 0.025 + shift_m, 0.002)}};
      const Lifting lifting(parts, {});
      EXPECT_FALSE(lifting.in_the_way(0)) << "yaw " << yaw << ", " << shift_m;
      EXPECT_FALSE(lifting.in_the_way(1)) << "yaw " << yaw << ", " << shift_m;
    }
  }
}

TEST(Lifting, AOneThatLeansOnAnotherIsFree) {
  Eigen::Isometry3d T = BlockPile::at(0, 0.03, 0.035);
  T.rotate(Eigen::AngleAxisd(0.6, Vector3d::UnitX()));
  const std::vector<PlacedPart> parts = {{&square_bar(), BlockPile::at(0, 0, 0.0125)},
                                         {&square_bar(), T}};
  const Lifting lifting(parts, {});
  EXPECT_FALSE(lifting.in_the_way(1));
}

TEST(Lifting, APipeThroughARingIsHooked) {
  const auto catalogue =
      parts::Catalogue::load(std::filesystem::path(GRASPD_SOURCE_DIR) / "deploy/parts");
  ASSERT_TRUE(catalogue) << catalogue.error().message;
  // The ring stands on its edge; the bolt's shank is 16 mm thick and goes through it.
  Eigen::Isometry3d T_ring = BlockPile::at(0, 0, 0.03);
  T_ring.rotate(Eigen::AngleAxisd(M_PI / 2, Vector3d::UnitY()));
  Eigen::Isometry3d T_bolt = BlockPile::at(0.03, 0, 0.03);
  T_bolt.rotate(Eigen::AngleAxisd(M_PI / 2, Vector3d::UnitY()));
  const std::vector<PlacedPart> parts = {{catalogue->find("flanged_ring"), T_ring},
                                         {catalogue->find("hex_bolt"), T_bolt}};
  const Lifting lifting(parts, {});
  EXPECT_EQ(lifting.in_the_way(0), 1U) << "the ring takes the bolt with it";
  EXPECT_EQ(lifting.in_the_way(1), 0U) << "and the bolt the ring";
}

TEST(Lifting, OnlyAWallIsAWall) {
  const Bin bin{Eigen::Isometry3d::Identity(), Vector3d(0.3, 0.2, 0.1), 0.005};
  const auto meets = [&](const Eigen::Isometry3d& T) {
    const std::vector<PlacedPart> parts = {{&square_bar(), T}};
    return Lifting(parts, {}).meets_wall(0, bin);
  };
  EXPECT_FALSE(meets(BlockPile::at(0.11, 0, 0.0125))) << "it touches the wall";
  EXPECT_TRUE(meets(BlockPile::at(0.13, 0, 0.0125))) << "20 mm in the wall";
  EXPECT_FALSE(meets(BlockPile::at(0.13, 0, 0.12))) << "over the rim";
}

}  // namespace
}  // namespace graspd::perception
