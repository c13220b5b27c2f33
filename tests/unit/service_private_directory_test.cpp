#include <gtest/gtest.h>

#include <optional>

#include "graspd/service/private_directory.hpp"
#include "temporary_folder.hpp"

namespace graspd::service {
namespace {

TEST(PrivateDirectory, IsTheUsersAloneAndGoneWithTheObject) {
  const testing::TemporaryFolder parent;
  std::filesystem::path path;
  {
    const PrivateDirectory directory(parent.path());
    path = directory.path();
    EXPECT_EQ(std::filesystem::status(path).permissions(), std::filesystem::perms::owner_all);
  }
  EXPECT_FALSE(std::filesystem::exists(path));
  EXPECT_TRUE(std::filesystem::is_empty(parent.path()));
}

TEST(PrivateDirectory, RemovesWhatAKilledServerLeftAndNothingElse) {
  const testing::TemporaryFolder parent;
  parent.write("graspd-serve-dead01/server.yaml", "left over");
  parent.write("something-else/file", "not ours");
  const PrivateDirectory living(parent.path());
  EXPECT_FALSE(std::filesystem::exists(parent.path() / "graspd-serve-dead01"));
  const PrivateDirectory next(parent.path());
  EXPECT_TRUE(std::filesystem::exists(living.path()));
  EXPECT_NE(living.path(), next.path());
  EXPECT_TRUE(std::filesystem::exists(parent.path() / "something-else/file"));
}

TEST(PrivateDirectory, SaysWhereItCannotBe) {
  EXPECT_THROW(PrivateDirectory("/nowhere"), std::system_error);
}

}  // namespace
}  // namespace graspd::service
