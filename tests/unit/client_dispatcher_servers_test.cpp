#include <gmock/gmock.h>

#include "client_dispatcher_fixture.hpp"

namespace graspd::client::dispatching {
namespace {

using std::chrono::seconds;

TEST_F(DispatcherTest, ARetiringServerEndsWhatItHasAndGetsNothingNew) {
  dispatcher_.connected(0);
  dispatcher_.add(id(1), kStart, kDeadline);
  EXPECT_EQ(attempt(kStart).server, 0u);
  dispatcher_.connected(1);
  dispatcher_.retire(0);
  EXPECT_THAT(dispatcher_.take_gone(), ::testing::IsEmpty());
  for (int number = 2; number < 5; ++number) {
    dispatcher_.add(id(number), kStart, kDeadline);
    EXPECT_EQ(attempt(kStart).server, 1u);
  }
  EXPECT_TRUE(dispatcher_.answered(0, answer(1), kStart));
  EXPECT_THAT(dispatcher_.take_gone(), ::testing::ElementsAre(0));
  EXPECT_THAT(dispatcher_.take_gone(), ::testing::IsEmpty());
}

TEST_F(DispatcherTest, AServerThatIsKeptAfterAllIsAskedAgain) {
  dispatcher_.connected(0);
  dispatcher_.retire(0);
  dispatcher_.keep(0);
  EXPECT_THAT(dispatcher_.take_gone(), ::testing::IsEmpty());
  dispatcher_.add(id(1), kStart, kDeadline);
  EXPECT_EQ(attempt(kStart).server, 0u);
}

TEST_F(DispatcherTest, AnIndexThatIsFreeIsTakenByAnotherServerThatNobodyHasTried) {
  dispatcher_.connected(0);
  dispatcher_.add(id(1), kStart, kDeadline);
  EXPECT_EQ(attempt(kStart).server, 0u);
  dispatcher_.retire(0);
  dispatcher_.disconnected(0, kStart);
  EXPECT_THAT(dispatcher_.take_gone(), ::testing::ElementsAre(0));
  EXPECT_EQ(dispatcher_.add_server("tcp://c:1"), 0u);
  EXPECT_EQ(dispatcher_.add_server("tcp://d:1"), 2u);
  const TimePoint later = kStart + seconds(1);
  expect_nothing(later);  // it has to be connected first
  dispatcher_.connected(1);
  dispatcher_.connected(2);
  EXPECT_NE(attempt(later).server, 0u);
}

TEST(Dispatcher, WithoutAServerWaitsForOneThenSaysWhy) {
  Dispatcher dispatcher({}, DispatchOptions{}, 1);
  dispatcher.no_server(Error{Code::kUnavailable, "no address"});
  dispatcher.add(id(1), kStart, kDeadline);
  EXPECT_TRUE(dispatcher.step(kStart).failed.empty());
  const auto step = dispatcher.step(kStart + DispatchOptions{}.connect_timeout);
  ASSERT_EQ(step.failed.size(), 1u);
  EXPECT_EQ(step.failed[0].error.message, "no address");
}

}  // namespace
}  // namespace graspd::client::dispatching
