#include <gtest/gtest.h>

#include "poison_list.hpp"

namespace graspd::service {
namespace {

TEST(PoisonList, TakesTwoDeaths) {
  PoisonList list;
  EXPECT_FALSE(list.contains(7));
  EXPECT_FALSE(list.add_death(7));
  EXPECT_FALSE(list.contains(7));
  EXPECT_FALSE(list.add_death(8));
  EXPECT_TRUE(list.add_death(7));
  EXPECT_TRUE(list.contains(7));
  EXPECT_FALSE(list.contains(8));
}

TEST(PoisonList, ForgetsTheOldestAndNoOther) {
  PoisonList list;
  for (const std::uint64_t poison : {1, 2}) {
    list.add_death(poison);
    list.add_death(poison);
  }
  for (std::uint64_t i = 0; i + 1 < PoisonList::kMost_n; ++i) list.add_death(100 + i);
  EXPECT_FALSE(list.contains(1));
  EXPECT_TRUE(list.contains(2));
}

}  // namespace
}  // namespace graspd::service
