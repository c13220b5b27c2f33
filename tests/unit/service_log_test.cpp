#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "service_front_support.hpp"

// The log's lines, which must be enough to find a request, to explain it, and to send it again.
namespace graspd::service {
namespace {

using client::Client;
using nlohmann::json;
using ::testing::HasSubstr;

std::vector<json> lines_with(RunningFront& front, const std::string& key) {
  wait_until_told(front);
  std::vector<json> lines;
  for (const std::string& text : front.log()) {
    EXPECT_EQ(text.find('\n'), std::string::npos);
    json line = json::parse(text);
    if (line.contains(key)) lines.push_back(std::move(line));
  }
  return lines;
}

TEST(Log, OneLineOfAPlannedRequest) {
  ThreadLauncher launcher = threads();
  RunningFront front(scripted_config(0), launcher);
  Client client({front.data_endpoint}, options_of("cell_7"));
  const RequestId id{0xab, 1};
  ASSERT_TRUE(client.plan(example_frame(), example_request({"echo", "other"}), kBudget, id));
  const auto lines = lines_with(front, "request_id");
  ASSERT_EQ(lines.size(), 1u);
  const json& line = lines[0];
  EXPECT_EQ(line.at("request_id"), "ab010000000000000000000000000000");
  EXPECT_EQ(line.at("attempt"), 1);
  EXPECT_EQ(line.at("cell"), "cell_7");
  EXPECT_EQ(line.at("parts"), json({"echo", "other"}));
  EXPECT_EQ(line.at("code"), "OK");
  EXPECT_EQ(line.at("outcome"), "PLANNED");
  EXPECT_EQ(line.at("objects_n"), 2);
  EXPECT_EQ(line.at("grasps_n"), 0);
  EXPECT_GT(line.at("budget_ms"), 0);
  EXPECT_GE(line.at("total_ms"), line.at("queue_ms"));
  for (const std::string stage : {"queue", "decode", "script"}) {
    EXPECT_TRUE(line.at("stages_ms").contains(stage)) << stage;
  }
  EXPECT_EQ(line.at("frame").at("width_px"), 16);
  EXPECT_EQ(line.at("frame").at("bytes"), 16 * 12 * 2);
  EXPECT_EQ(line.at("frame").at("encoding"), "raw");
  EXPECT_EQ(line.at("frame").at("crc32").get<std::string>().size(), 8u);
  EXPECT_EQ(line.at("build"), "scripted");
  EXPECT_EQ(line.at("catalogue_hash"), "catalogue");
  EXPECT_EQ(line.at("config_hash"), "config");
  EXPECT_FALSE(line.contains("recorded"));
}

TEST(Log, RefusalsSayWhy) {
  ThreadLauncher launcher = threads();
  RunningFront front(scripted_config(0), launcher);
  Client client({front.data_endpoint}, options_of("cell_7"));
  ASSERT_FALSE(client.plan(example_frame(), example_request({"gizmo"}), kBudget));
  ASSERT_FALSE(client.plan(example_frame(), example_request({"throw"}), kBudget));
  const auto lines = lines_with(front, "request_id");
  ASSERT_EQ(lines.size(), 2u);
  EXPECT_EQ(lines[0].at("code"), "UNKNOWN_PART");
  EXPECT_EQ(lines[0].at("cell"), "cell_7");
  EXPECT_THAT(lines[0].at("message"), HasSubstr("'gizmo'"));
  EXPECT_EQ(lines[1].at("code"), "INTERNAL");
  EXPECT_THAT(lines[1].at("message"), HasSubstr("the script says so"));
}

TEST(Log, IsJsonWhateverSentencesHold) {
  ThreadLauncher launcher =
      threads([](const DepthFrame&, const PlanRequest&, TimePoint) -> Result<PlanAnswer> {
        throw std::runtime_error("\"quotes\"\nline feed, escape \x1b[2J");
      });
  RunningFront front(scripted_config(0), launcher);
  Client client({front.data_endpoint});
  EXPECT_FALSE(client.plan(example_frame(), example_request(), kBudget));
  const auto lines = lines_with(front, "request_id");
  ASSERT_FALSE(lines.empty());
  EXPECT_THAT(lines[0].at("message"), HasSubstr("\"quotes\"\nline feed"));
}

}  // namespace
}  // namespace graspd::service
