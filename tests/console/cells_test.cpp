#include "cells.hpp"

#include <gmock/gmock.h>

#include <nlohmann/json.hpp>
#include <thread>

namespace graspd::console {
namespace {

using namespace std::chrono_literals;
using nlohmann::json;
using ::testing::IsEmpty;
using ::testing::SizeIs;

PlanSeen plan(const std::string& cell, int n) {
  PlanSeen seen;
  seen.cell = cell;
  seen.flight = fmt::format("{}/2026-11-23T00-00-00.{:06}Z_{:032x}.flight", cell, n, n);
  seen.code = "OK";
  seen.outcome = "PLANNED";
  return seen;
}

pick_records::PickLine pick(int n, const std::string& verdict) {
  pick_records::PickLine line;
  line.request_id = fmt::format("{:032x}", n);
  line.verdict = verdict;
  line.rank = 1;
  line.end_s = 2;
  line.steps_ms = {{"plan", 41.5}};
  return line;
}

json history(const Cells& cells) { return json::parse(cells.history("a")); }

TEST(ConsoleCells, ForgetWhatIsOld) {
  Cells cells;
  for (int n = 0; n < 1000; ++n) {
    cells.add(plan("a", n));
    cells.add("a", pick(n, "PLACED"));
  }
  ASSERT_THAT(history(cells), SizeIs(kMostPlans_n));
  EXPECT_EQ(history(cells).back()["flight"], plan("a", 999).flight);
}

TEST(ConsoleCells, AreNoMoreThanAPageCanList) {
  Cells cells;
  for (std::size_t n = 0; n < kMostCells_n + 10; ++n) cells.add(plan(fmt::format("cell_{}", n), 0));
  std::uint64_t seen = 0;
  EXPECT_THAT(cells.changes_since(seen, 0ms), SizeIs(kMostCells_n));
}

TEST(ConsoleCells, TellWhoIsSlowTheNewestOnce) {
  Cells cells;
  for (int n = 0; n < 30; ++n) cells.add(plan("a", n));
  std::uint64_t seen = 0;
  const auto events = cells.changes_since(seen, 0ms);
  ASSERT_THAT(events, SizeIs(1));
  EXPECT_EQ(json::parse(events[0].data)["plan"]["flight"], plan("a", 29).flight);
  EXPECT_THAT(cells.changes_since(seen, 0ms), IsEmpty());
}

TEST(ConsoleCells, KeepPlansInTheOrderOfTimeAndEachOnce) {
  Cells cells;
  for (const int n : {5, 3, 4, 5, 1}) cells.add(plan("a", n));
  std::vector<std::string> flights;
  for (const json& line : history(cells)) flights.push_back(line["flight"]);
  EXPECT_TRUE(std::ranges::is_sorted(flights));
  EXPECT_THAT(flights, SizeIs(4));
}

TEST(ConsoleCells, SayWhatBecameOfAPlan) {
  Cells cells;
  cells.add(plan("a", 7));
  EXPECT_FALSE(history(cells)[0].contains("pick"));
  cells.add("a", pick(7, "MISSED"));
  EXPECT_EQ(history(cells)[0]["pick"]["verdict"], "MISSED");
  cells.add("a", pick(8, "PLACED"));
  std::uint64_t seen = 0;
  const json cell = json::parse(cells.changes_since(seen, 0ms).at(0).data);
  EXPECT_EQ(cell["picks_n"], 2);
  EXPECT_EQ(cell["placed_n"], 1);
  EXPECT_EQ(cell["cycle_s"], 2);
  EXPECT_EQ(cell["round_trip_ms"], 41.5);
}

TEST(ConsoleCells, WakeWhoWaits) {
  Cells cells;
  std::uint64_t seen = 0;
  std::thread other([&] { cells.add(plan("a", 0)); });
  EXPECT_THAT(cells.changes_since(seen, 30s), SizeIs(1));
  other.join();
}

TEST(ConsoleCells, ABadByteInANameIsReplaced) {
  Cells cells;
  cells.add(plan("a\xff", 0));
  std::uint64_t seen = 0;
  EXPECT_EQ(json::parse(cells.changes_since(seen, 0ms).at(0).data)["cell"], "a\uFFFD");
}

}  // namespace
}  // namespace graspd::console
