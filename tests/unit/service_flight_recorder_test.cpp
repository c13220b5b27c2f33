#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <map>
#include <optional>

#include "service_front_support.hpp"
#include "service_raw_client.hpp"
#include "temporary_folder.hpp"

// Which requests the front hands to the flight recorder, and that nobody waits for it.
namespace graspd::service {
namespace {

namespace fs = std::filesystem;
using client::Client;
using graspd::testing::TemporaryFolder;

class FlightRecorderTest : public ::testing::Test {
 protected:
  FlightRecorderTest() { config_.flight_recorder.folder = temporary_.path() / "flights"; }

  /// In the order of their time.
  std::vector<FlightRecord> flights() const {
    std::map<std::string, FlightRecord> flights;
    if (!fs::exists(config_.flight_recorder.folder)) return {};
    for (const auto& entry : fs::recursive_directory_iterator(config_.flight_recorder.folder)) {
      if (entry.path().extension() != kFlightExtension) continue;
      std::ifstream file(entry.path(), std::ios::binary);
      const std::string bytes(std::istreambuf_iterator<char>(file), {});
      const auto flight = codec::decode_flight(std::as_bytes(std::span(bytes)));
      EXPECT_TRUE(flight) << flight.error().message;
      if (flight) flights[entry.path().filename().string()] = *flight;
    }
    std::vector<FlightRecord> sorted;
    for (auto& [name, flight] : flights) sorted.push_back(std::move(flight));
    return sorted;
  }
  static Answer answer_of(const FlightRecord& flight) {
    return codec::decode_answer(std::as_bytes(std::span(flight.answer))).value();
  }
  static int lines_with(RunningFront& front, const std::string& text) {
    int n = 0;
    for (const std::string& line : front.log()) n += line.find(text) != std::string::npos ? 1 : 0;
    return n;
  }

  TemporaryFolder temporary_;
  ServerConfig config_ = scripted_config(0);
};

TEST_F(FlightRecorderTest, KeepsWhatFailedAsItCame) {
  config_.workers_n = 1;
  ProcessLauncher launcher = processes();
  const RequestId id{0xcd, 2};
  std::optional<RunningFront> front(std::in_place, config_, launcher);
  Client client({front->data_endpoint}, options_of("cell", 1));
  EXPECT_TRUE(client.plan(example_frame(), example_request(), kBudget));
  EXPECT_FALSE(client.plan(example_frame(), example_request({"crash"}), kBudget, id));
  EXPECT_EQ(lines_with(*front, "recorded"), 1);
  front.reset();  // what is waiting is written

  const auto kept = flights();
  ASSERT_EQ(kept.size(), 1u);
  EXPECT_EQ(kept[0].cell, "cell");
  EXPECT_EQ(kept[0].server.build, kScriptedServer.build);
  EXPECT_NEAR(kept[0].stamp_s, static_cast<double>(std::time(nullptr)), 60);
  EXPECT_EQ(answer_of(kept[0]).code, Code::kInternal);
  EXPECT_EQ(answer_of(kept[0]).id, id);

  // Sent again as they are, they are the same request: it crashes a worker once more.
  RunningFront again(config_, launcher);
  RawClient raw(again.data_endpoint);
  raw.send({kept[0].request, kept[0].depth_image});
  const Answer answer = raw.receive();
  EXPECT_EQ(answer.id, id);
  EXPECT_EQ(answer.code, Code::kInternal);
}

TEST_F(FlightRecorderTest, KeepsWhatAsksForIt) {
  ThreadLauncher launcher = threads();
  PlanRequest request = example_request();
  request.options.record = true;
  {
    RunningFront front(config_, launcher);
    Client client({front.data_endpoint}, options_of("cell", 1));
    ASSERT_TRUE(client.plan(example_frame(), example_request(), kBudget));
    ASSERT_TRUE(client.plan(example_frame(), request, kBudget));
  }
  const auto kept = flights();
  ASSERT_EQ(kept.size(), 1u);
  EXPECT_EQ(answer_of(kept[0]).code, Code::kOk);
}

TEST_F(FlightRecorderTest, WhereItIsToKeepAllItKeepsTheLatestOfEachCellThatAWorkerWasGiven) {
  config_.flight_recorder.keep = FlightsKept::kAll;
  config_.flight_recorder.per_cell_n = 2;
  ThreadLauncher launcher = threads();
  std::vector<RequestId> ids;
  {
    RunningFront front(config_, launcher);
    Client busy({front.data_endpoint}, options_of("busy", 1));
    Client quiet({front.data_endpoint}, options_of("quiet", 1));
    ASSERT_TRUE(quiet.plan(example_frame(), example_request(), kBudget));
    for (int i = 0; i < 5; ++i) {
      ids.push_back(client::new_request_id());
      ASSERT_TRUE(busy.plan(example_frame(), example_request(), kBudget, ids.back()));
    }
    EXPECT_FALSE(busy.plan(example_frame(), example_request({"gizmo"}), kBudget));
  }
  const auto kept = flights();
  ASSERT_EQ(kept.size(), 3u);
  EXPECT_EQ(kept[0].cell, "quiet");
  EXPECT_EQ(answer_of(kept[1]).id, ids[3]);
  EXPECT_EQ(answer_of(kept[2]).id, ids[4]);
}

TEST_F(FlightRecorderTest, WhatCantBeKeptCostsNoAnswerAndIsSaidOnce) {
  config_.flight_recorder.folder = temporary_.write("file", "in the way");
  config_.flight_recorder.keep = FlightsKept::kAll;
  ThreadLauncher launcher = threads();
  RunningFront front(config_, launcher);
  Client client({front.data_endpoint});
  for (int i = 0; i < 5; ++i) {
    ASSERT_TRUE(client.plan(example_frame(), example_request(), kBudget));
  }
  front.wait_for_log("records are lost from now on, answers are not");
  fs::remove(config_.flight_recorder.folder);
  ASSERT_TRUE(client.plan(example_frame(), example_request(), kBudget));
  front.wait_for_log("records are kept again; ");
  EXPECT_EQ(lines_with(front, "records are lost"), 1);
}

}  // namespace
}  // namespace graspd::service
