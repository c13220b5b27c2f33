#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "graspd/codec/codec.hpp"
#include "random_messages.hpp"
#include "same_message.hpp"
#include "schema.hpp"

// What is kept to be asked again, and compared: requests as bytes and JSON, answers as JSON, files
// of the flight recorder.
namespace graspd::testing {
namespace {

using ::testing::HasSubstr;

std::string image_of(const codec::EncodedFrame& frame) {
  return {reinterpret_cast<const char*>(frame.payload.data()), frame.payload.size()};
}

TEST(Again, ARequestComesBackFromItsJsonToTheBit) {
  RandomMessages random(11);
  for (int i = 0; i < 100; ++i) {
    const auto frame = codec::encode_frame(random.any_depth_frame(), DepthEncoding::kRaw);
    const std::string first =
        codec::encode_request({.cell = "", .call = PlanCall{frame.description, random.any_plan()}});
    const auto json = codec::plan_request_json(as_bytes(first));
    ASSERT_TRUE(json) << json.error().message;
    const auto again = codec::request_from_json(*json, frame.description);
    ASSERT_TRUE(again) << again.error().message;
    EXPECT_EQ(*again, first);
  }
}

TEST(Again, OnlyTheHeaderOfARequestChanges) {
  RandomMessages random(12);
  const Request request = random.plan_request();
  const std::string bytes = codec::encode_request(request);
  const codec::RequestHeader other{{1, 2, 3}, 2, "other", 77};
  const auto changed = codec::with_header(as_bytes(bytes), other);
  ASSERT_TRUE(changed);
  const auto decoded = codec::decode_request(as_bytes(*changed));
  ASSERT_TRUE(decoded) << decoded.error().message;
  EXPECT_EQ(decoded->id, other.id);
  EXPECT_EQ(decoded->attempt, 2u);
  EXPECT_EQ(decoded->cell, "other");
  EXPECT_EQ(decoded->budget_ms, 77u);
  const auto back = codec::with_header(
      as_bytes(*changed), {request.id, request.attempt, request.cell, request.budget_ms});
  EXPECT_EQ(*back, bytes);
}

TEST(Again, AnAnswerComesBackFromItsJson) {
  RandomMessages random(13);
  for (int i = 0; i < 100; ++i) {
    PlanAnswer answer = random.any_plan_answer();
    const auto again = codec::plan_answer_from_json(codec::to_json(answer, i % 2 == 0));
    ASSERT_TRUE(again) << again.error().message;
    EXPECT_TRUE(same(*again, answer));
  }
}

TEST(Again, AnAnswersBytesAndTheirJsonAreReadAlikeToTheBit) {
  RandomMessages random(16);
  for (int i = 0; i < 100; ++i) {
    const std::string bytes = codec::encode_answer(random.plan_answer());
    const auto json = codec::plan_answer_json(as_bytes(bytes));
    ASSERT_TRUE(json) << json.error().message;
    const PlanAnswer a = std::get<PlanAnswer>(codec::decode_answer(as_bytes(bytes))->body);
    const auto b = codec::plan_answer_from_json(*json);
    ASSERT_TRUE(b) << b.error().message;
    ASSERT_EQ(a.objects.size(), b->objects.size());
    for (std::size_t k = 0; k < a.objects.size(); ++k) {
      EXPECT_EQ(a.objects[k].T_base_part.matrix(), b->objects[k].T_base_part.matrix());
    }
  }
}

TEST(Again, WhatIsNoAnswerOrNoRequestIsNamed) {
  EXPECT_THAT(codec::plan_answer_from_json("{").error().message, HasSubstr("graspd.v1.PlanAnswer"));
  EXPECT_THAT(codec::plan_answer_from_json("{}").error().message, HasSubstr("outcome"));
  const std::string health = codec::encode_request({.cell = "", .call = HealthCall{}});
  EXPECT_THAT(codec::plan_request_json(as_bytes(health)).error().message, HasSubstr("no plan"));
  RandomMessages random(14);
  const auto frame = codec::encode_frame(random.any_depth_frame(), DepthEncoding::kRaw);
  const auto refused = codec::request_from_json(R"({"parts": []})", frame.description);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, Code::kInvalidArgument);
}

class FlightFile : public ::testing::Test {
 protected:
  static FlightRecord flight() {
    RandomMessages random(15);
    const auto frame = codec::encode_frame(random.any_depth_frame(), DepthEncoding::kRvl);
    return {.cell = "tees",
            .stamp_s = 1.7e9 + 0.123456,
            .server = {"build", "catalogue", "config"},
            .request = codec::encode_request(
                {.cell = "", .call = PlanCall{frame.description, random.any_plan()}}),
            .depth_image = image_of(frame),
            .answer = codec::encode_answer(random.plan_answer())};
  }
};

TEST_F(FlightFile, ComesBackInEveryField) {
  const FlightRecord kept = flight();
  const auto read = codec::decode_flight(as_bytes(codec::encode_flight(kept)));
  ASSERT_TRUE(read) << read.error().message;
  EXPECT_EQ(read->cell, kept.cell);
  EXPECT_EQ(read->stamp_s, kept.stamp_s);
  EXPECT_EQ(read->server.build, "build");
  EXPECT_EQ(read->server.catalogue_hash, "catalogue");
  EXPECT_EQ(read->server.config_hash, "config");
  EXPECT_EQ(read->request, kept.request);
  EXPECT_EQ(read->depth_image, kept.depth_image);
  EXPECT_EQ(read->answer, kept.answer);
}

TEST_F(FlightFile, CutShortItIsRefused) {
  const std::string whole = codec::encode_flight(flight());
  for (std::size_t size = 0; size < whole.size(); size += 1 + whole.size() / 200) {
    EXPECT_FALSE(codec::decode_flight(as_bytes(whole.substr(0, size)))) << size;
  }
}

TEST_F(FlightFile, DamageNeverChangesWhatItHolds) {
  const FlightRecord kept = flight();
  const std::string whole = codec::encode_flight(kept);
  int refused_n = 0;
  for (std::size_t at = 0; at < whole.size(); at += 1 + whole.size() / 500) {
    std::string damaged = whole;
    damaged[at] = static_cast<char>(damaged[at] ^ 0x04);
    const auto read = codec::decode_flight(as_bytes(damaged));
    refused_n += read ? 0 : 1;
    if (!read) continue;
    EXPECT_EQ(read->request, kept.request) << at;
    EXPECT_EQ(read->depth_image, kept.depth_image) << at;
    EXPECT_EQ(read->answer, kept.answer) << at;
  }
  EXPECT_GT(refused_n, 400);
}

}  // namespace
}  // namespace graspd::testing
