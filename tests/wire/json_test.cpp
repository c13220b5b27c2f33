#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "graspd/codec/codec.hpp"
#include "random_messages.hpp"

namespace graspd::testing {
namespace {

using ::testing::HasSubstr;

TEST(Json, HasTheNamesOfTheSchema) {
  RandomMessages random(1);
  PlanAnswer answer = random.any_plan_answer();
  answer.outcome = Outcome::kBinEmpty;
  answer.objects[0].T_base_part.translation() = Eigen::Vector3d(0.25, 0, 0);
  const std::string json = codec::to_json(answer, false);
  EXPECT_THAT(json, HasSubstr(R"("outcome":"BIN_EMPTY")"));
  EXPECT_THAT(json, HasSubstr(R"("T_base_part":{"translation_m":{"x":0.25,"y":0,"z":0})"));
  EXPECT_THAT(json, HasSubstr(R"("opening_width_m":)"));
  EXPECT_THAT(codec::to_json(random.any_health_answer(), false), HasSubstr(R"("workers_busy_n":)"));
}

TEST(Json, SaysWhatWasAskedFor) {
  PlanRequest request;
  request.parts = {{"tee", 2}};
  request.failed_spots = {{{0.25, 0, 0}, 0.02, 1, "link 4 would touch the bin"}};
  const std::string json = codec::to_json(request, false);
  EXPECT_THAT(json, HasSubstr(R"("parts":[{"id":"tee","priority":2}])"));
  EXPECT_THAT(json, HasSubstr(R"("reason":"link 4 would touch the bin")"));
}

TEST(Json, PrintsZerosAndEmptyLists) {
  const std::string json = codec::to_json(PlanAnswer{}, false);
  EXPECT_THAT(json, HasSubstr(R"("registered_n":0)"));
  EXPECT_THAT(json, HasSubstr(R"("grasps":[])"));
}

TEST(Json, IsOneLineOrIndented) {
  EXPECT_EQ(codec::to_json(PlanAnswer{}, false).find('\n'), std::string::npos);
  EXPECT_THAT(codec::to_json(PlanAnswer{}, true), HasSubstr("\n \"outcome\": \"PLANNED\""));
}

}  // namespace
}  // namespace graspd::testing
