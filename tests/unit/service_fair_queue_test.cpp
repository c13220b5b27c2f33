#include <gtest/gtest.h>

#include <map>
#include <random>
#include <set>

#include "graspd/service/fair_queue.hpp"
#include "start_time.hpp"

namespace graspd::service {
namespace {

using std::chrono::milliseconds;

const TimePoint kNever = kStart + std::chrono::hours(1);

Waiting waiting(Ticket ticket, std::string cell, TimePoint deadline = kNever) {
  return {ticket, std::move(cell), deadline};
}

TEST(FairQueue, GivesBackWhatWasPushedInOrderWithinOneCell) {
  FairQueue queue(2, 4);
  EXPECT_FALSE(queue.start());
  EXPECT_FALSE(queue.push(waiting(1, "a")));
  EXPECT_FALSE(queue.push(waiting(2, "a")));
  EXPECT_EQ(queue.start()->ticket, 1u);
  EXPECT_EQ(queue.start()->ticket, 2u);
  EXPECT_FALSE(queue.start());
  EXPECT_EQ(queue.running_n(), 2u);
}

TEST(FairQueue, LatestFrameTakesTheOldestOnesPlace) {
  FairQueue queue(2, 1);
  queue.push(waiting(1, "a"));
  queue.push(waiting(2, "a"));
  const auto superseded = queue.push(waiting(3, "a"));
  ASSERT_TRUE(superseded);
  EXPECT_EQ(superseded->ticket, 1u);
  EXPECT_EQ(queue.start()->ticket, 2u);
  EXPECT_EQ(queue.start()->ticket, 3u);
}

TEST(FairQueue, QuietCellWaitsForOneTurnOfTheNoisyOneAtMost) {
  FairQueue queue(2, 1);
  Ticket next = 1;
  for (int i = 0; i < 10; ++i) queue.push(waiting(next++, "noisy"));
  queue.push(waiting(100, "quiet"));
  std::vector<Ticket> started;
  for (int i = 0; i < 2; ++i) {
    const auto job = queue.start();
    started.push_back(job->ticket);
    queue.push(waiting(next++, "noisy"));
    queue.finish(job->cell);
  }
  EXPECT_EQ(started[1], 100u);
}

TEST(FairQueue, ACellThatComesBackEachTimeAlternatesWithANoisyOne) {
  FairQueue queue(2, 1);
  for (const Ticket ticket : {1, 2}) queue.push(waiting(ticket, "noisy"));
  std::string starts;
  for (Ticket ticket = 3; ticket < 23; ticket += 2) {
    const auto started = queue.start();
    starts += started->cell.front();
    // While it runs, both ask again.
    queue.push(waiting(ticket, "noisy"));
    if (started->cell == "noisy") queue.push(waiting(ticket + 1, "quiet"));
    queue.finish(started->cell);
  }
  EXPECT_EQ(starts, "nqnqnqnqnq");
}

TEST(FairQueue, NewCellsWithoutEndDoNotStarveAnother) {
  FairQueue queue(2, 1);
  Ticket ticket = 1;
  queue.push(waiting(ticket, "old"));
  int old_starts_n = 0;
  for (int i = 0; i < 20; ++i) {
    const auto started = queue.start();
    old_starts_n += started->cell == "old" ? 1 : 0;
    queue.push(waiting(++ticket, "new" + std::to_string(i)));
    queue.push(waiting(++ticket, "old"));
    queue.finish(started->cell);
  }
  EXPECT_GE(old_starts_n, 4);
}

TEST(FairQueue, OneCellHoldsAQuarterOfTheWorkersWhileAnotherWaits) {
  FairQueue queue(2, 8);
  for (Ticket ticket = 1; ticket <= 2; ++ticket) queue.push(waiting(ticket, "noisy"));
  EXPECT_EQ(queue.start()->cell, "noisy");
  EXPECT_EQ(queue.start()->cell, "noisy");
  queue.push(waiting(3, "noisy"));
  queue.push(waiting(4, "quiet"));
  EXPECT_EQ(queue.start()->cell, "quiet") << "noisy has its two of eight already";
  EXPECT_EQ(queue.start()->cell, "noisy") << "nobody else waits, so no worker may idle";
}

TEST(FairQueue, TakesOutWhatHasExpired) {
  FairQueue queue(2, 1);
  queue.push(waiting(1, "a", kStart + milliseconds(10)));
  queue.push(waiting(2, "a", kStart + milliseconds(30)));
  queue.push(waiting(3, "b", kStart + milliseconds(20)));
  EXPECT_EQ(queue.earliest_deadline(), kStart + milliseconds(10));
  const auto expired = queue.expire(kStart + milliseconds(20));
  std::set<Ticket> tickets;
  for (const Waiting& request : expired) tickets.insert(request.ticket);
  EXPECT_EQ(tickets, (std::set<Ticket>{1, 3}));
  EXPECT_EQ(queue.queued_n(), 1u);
  EXPECT_EQ(queue.start()->ticket, 2u);
  EXPECT_FALSE(queue.earliest_deadline());
}

TEST(FairQueue, FinishOfAnIdleCellIsAMistake) {
  FairQueue queue(2, 1);
  EXPECT_THROW(queue.finish("a"), std::logic_error);
}

// Random traffic from a fixed seed, with invariants after every step.
TEST(FairQueue, LosesAndDoublesNothing) {
  std::mt19937 random(7);
  FairQueue queue(2, 4);
  std::set<Ticket> inside;
  std::map<std::string, std::size_t> running;
  Ticket next = 1;
  for (int step = 0; step < 20'000; ++step) {
    const std::string cell(1, static_cast<char>('a' + random() % 5));
    switch (random() % 4) {
      case 0:
      case 1: {
        const auto deadline = kStart + milliseconds(step + static_cast<int>(random() % 50));
        inside.insert(next);
        if (const auto old = queue.push(waiting(next++, cell, deadline))) {
          EXPECT_EQ(old->cell, cell);
          EXPECT_EQ(inside.erase(old->ticket), 1u);
        }
        break;
      }
      case 2: {
        const bool anything = queue.queued_n() > 0;
        const auto job = queue.start();
        EXPECT_EQ(job.has_value(), anything);
        if (job) {
          EXPECT_EQ(inside.erase(job->ticket), 1u);
          ++running[job->cell];
        }
        break;
      }
      default:
        if (running[cell] > 0) {
          queue.finish(cell);
          --running[cell];
        }
        for (const Waiting& late : queue.expire(kStart + milliseconds(step))) {
          EXPECT_EQ(inside.erase(late.ticket), 1u);
          EXPECT_LE(late.deadline, kStart + milliseconds(step));
        }
    }
    ASSERT_EQ(queue.queued_n(), inside.size());
  }
}

// `ahead_of` is a closed form; starting everything is its brute-force twin.
TEST(FairQueue, AheadOfCountsWhatReallyStartsBefore) {
  std::mt19937 random(11);
  for (int trial = 0; trial < 500; ++trial) {
    FairQueue queue(2, 1);
    for (int i = 0; i < static_cast<int>(random() % 12); ++i) {
      queue.push(
          waiting(static_cast<Ticket>(i), std::string(1, static_cast<char>('a' + random() % 4))));
      if (random() % 3 == 0) queue.finish(queue.start()->cell);
    }
    const auto running = random() % 2 == 0 ? queue.start() : std::nullopt;
    const std::string cell(1, static_cast<char>('a' + random() % 5));
    const std::size_t predicted = queue.ahead_of(cell);
    queue.push(waiting(1000, cell));
    if (running) queue.finish(running->cell);
    std::size_t before = 0;
    while (true) {
      const auto job = queue.start();
      ASSERT_TRUE(job);
      queue.finish(job->cell);
      if (job->ticket == 1000) break;
      ++before;
    }
    ASSERT_EQ(predicted, before) << "trial " << trial;
  }
}

}  // namespace
}  // namespace graspd::service
