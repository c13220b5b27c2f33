#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "graspd/service/supervisor.hpp"
#include "start_time.hpp"

namespace graspd::service {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

/// Workers that exist only as far as the supervisor can tell.
struct FakeWorker {
  std::string identity;
  std::optional<std::string> exit;
  bool killed = false;
};

class FakeHandle : public WorkerHandle {
 public:
  explicit FakeHandle(std::shared_ptr<FakeWorker> worker) : worker_(std::move(worker)) {}
  int exit_fd() const override { return -1; }
  std::optional<std::string> exit_reason() override { return worker_->exit; }
  void kill() override {
    worker_->killed = true;
    worker_->exit = "killed by signal 9";
  }
  std::string name() const override { return "fake"; }

 private:
  std::shared_ptr<FakeWorker> worker_;
};

class FakeLauncher : public WorkerLauncher {
 public:
  std::unique_ptr<WorkerHandle> launch(const std::string&, const std::string& identity) override {
    launched.push_back(std::make_shared<FakeWorker>(FakeWorker{identity, std::nullopt, false}));
    return std::make_unique<FakeHandle>(launched.back());
  }
  std::vector<std::shared_ptr<FakeWorker>> launched;
};

class SupervisorTest : public testing::Test {
 protected:
  void get_ready(std::size_t index, TimePoint now) {
    EXPECT_TRUE(supervisor_.heard(launcher_.launched[index]->identity, now));
    supervisor_.ready(launcher_.launched[index]->identity);
  }

  FakeLauncher launcher_;
  SupervisorLimits limits_;
  Supervisor supervisor_{2, "ipc://nowhere", launcher_, limits_};
};

TEST_F(SupervisorTest, LaunchesEveryWorkerOnceAndUsesThoseThatAreReady) {
  supervisor_.tend(kStart);
  supervisor_.tend(kStart);
  ASSERT_EQ(launcher_.launched.size(), 2u);
  EXPECT_FALSE(supervisor_.idle());
  get_ready(1, kStart);
  EXPECT_EQ(supervisor_.idle(), launcher_.launched[1]->identity);
  EXPECT_EQ(supervisor_.ready_n(), 1u);
}

TEST_F(SupervisorTest, HandsWorkToTheOneThatRestedLongest) {
  supervisor_.tend(kStart);
  get_ready(0, kStart);
  get_ready(1, kStart);
  const std::string first = *supervisor_.idle();
  supervisor_.assign(first, 7, kStart);
  EXPECT_EQ(supervisor_.busy_n(), 1u);
  const std::string second = *supervisor_.idle();
  EXPECT_NE(first, second);
  supervisor_.assign(second, 8, kStart);
  EXPECT_FALSE(supervisor_.idle());
  EXPECT_EQ(supervisor_.release(second, kStart + milliseconds(1)), 8u);
  EXPECT_EQ(supervisor_.release(first, kStart + milliseconds(2)), 7u);
  EXPECT_EQ(supervisor_.idle(), second);
  EXPECT_EQ(supervisor_.release(first, kStart), std::nullopt) << "it holds nothing now";
}

TEST_F(SupervisorTest, ADeadWorkerCostsTheRequestItHeldAndIsReplacedAtOnce) {
  supervisor_.tend(kStart);
  get_ready(0, kStart);
  supervisor_.assign(launcher_.launched[0]->identity, 7, kStart);
  launcher_.launched[0]->exit = "killed by signal 11";
  const auto report = supervisor_.tend(kStart + milliseconds(5));
  ASSERT_EQ(report.lost.size(), 1u);
  EXPECT_EQ(report.lost[0].ticket, 7u);
  EXPECT_THAT(report.lost[0].reason, testing::HasSubstr("signal 11"));
  ASSERT_EQ(launcher_.launched.size(), 3u);
  EXPECT_NE(launcher_.launched[2]->identity, launcher_.launched[0]->identity);
  EXPECT_FALSE(supervisor_.heard(launcher_.launched[0]->identity, kStart)) << "a ghost";
}

TEST_F(SupervisorTest, EndsAWorkerThatComputesTooLong) {
  supervisor_.tend(kStart);
  get_ready(0, kStart);
  get_ready(1, kStart);
  supervisor_.assign(launcher_.launched[0]->identity, 7, kStart);
  for (TimePoint now = kStart; now < kStart + limits_.job; now += seconds(1)) {
    supervisor_.heard(launcher_.launched[1]->identity, now);
    EXPECT_TRUE(supervisor_.tend(now).lost.empty());
  }
  supervisor_.tend(kStart + limits_.job);
  EXPECT_TRUE(launcher_.launched[0]->killed);
  EXPECT_FALSE(launcher_.launched[1]->killed);
  const auto report = supervisor_.tend(kStart + limits_.job);
  ASSERT_EQ(report.lost.size(), 1u);
  EXPECT_THAT(report.lost[0].reason, testing::HasSubstr("worker_time_limit_ms"));
}

TEST_F(SupervisorTest, EndsAnIdleWorkerThatFallsSilent) {
  supervisor_.tend(kStart);
  get_ready(0, kStart);
  get_ready(1, kStart);
  EXPECT_EQ(supervisor_.next_tend(), kStart + limits_.silence);
  supervisor_.heard(launcher_.launched[1]->identity, kStart + seconds(1));
  supervisor_.tend(kStart + limits_.silence);
  EXPECT_TRUE(launcher_.launched[0]->killed);
  EXPECT_FALSE(launcher_.launched[1]->killed);
}

TEST_F(SupervisorTest, AfterFailedStartsWaitsLongerEachTime) {
  supervisor_.tend(kStart);
  get_ready(0, kStart);
  TimePoint now = kStart;
  std::vector<milliseconds> waits;
  for (int failure = 0; failure < 8; ++failure) {
    supervisor_.heard(launcher_.launched[0]->identity, now);
    launcher_.launched.back()->exit = "ended with exit code 1";
    supervisor_.tend(now);
    const std::size_t launched = launcher_.launched.size();
    const TimePoint failed = now;
    while (launcher_.launched.size() == launched) {
      now += milliseconds(100);
      supervisor_.heard(launcher_.launched[0]->identity, now);
      supervisor_.tend(now);
    }
    waits.push_back(std::chrono::duration_cast<milliseconds>(now - failed));
  }
  EXPECT_EQ(waits.front(), limits_.first_back_off);
  EXPECT_EQ(waits[1], 2 * limits_.first_back_off);
  EXPECT_EQ(waits.back(), limits_.last_back_off);
}

TEST_F(SupervisorTest, GivesUpWhereNoWorkerEverGetsReady) {
  TimePoint now = kStart;
  EXPECT_THROW(
      for (int i = 0; i < 100; ++i) {
        supervisor_.tend(now);
        for (auto& worker : launcher_.launched) worker->exit = "ended with exit code 2";
        now += limits_.last_back_off;
      },
      std::runtime_error);
  EXPECT_LE(launcher_.launched.size(), 7u);
}

TEST_F(SupervisorTest, ARejectedWorkerIsEndedWithItsReason) {
  supervisor_.tend(kStart);
  get_ready(0, kStart);
  supervisor_.heard(launcher_.launched[1]->identity, kStart);
  supervisor_.reject(launcher_.launched[1]->identity, "other parts");
  EXPECT_TRUE(launcher_.launched[1]->killed);
  const auto report = supervisor_.tend(kStart);
  EXPECT_THAT(report.notices, testing::ElementsAre(testing::HasSubstr("other parts")));
}

}  // namespace
}  // namespace graspd::service
