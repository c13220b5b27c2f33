#include <gtest/gtest.h>

#include "graspd/codec/codec.hpp"
#include "random_messages.hpp"
#include "same_message.hpp"
#include "schema.hpp"

namespace graspd::testing {
namespace {

constexpr int kMessages_n = 300;

TEST(RoundTrip, RequestsComeBackInEveryField) {
  RandomMessages random(1);
  for (int i = 0; i < kMessages_n; ++i) {
    const Request request = random.any_request();
    const std::string bytes = codec::encode_request(request);
    const auto decoded = codec::decode_request(as_bytes(bytes));
    ASSERT_TRUE(decoded) << decoded.error().message;
    ASSERT_TRUE(same(*decoded, request));
    EXPECT_EQ(codec::salvage_request_id(as_bytes(bytes)), request.id);
  }
}

TEST(RoundTrip, AnswersComeBackInEveryField) {
  RandomMessages random(2);
  for (int i = 0; i < kMessages_n; ++i) {
    const Answer answer = random.any_answer();
    const auto decoded = codec::decode_answer(as_bytes(codec::encode_answer(answer)));
    ASSERT_TRUE(decoded) << decoded.error().message;
    ASSERT_TRUE(same(*decoded, answer));
  }
}

TEST(RoundTrip, WhatIsLeftOutComesBackLeftOut) {
  RandomMessages random(3);
  Request request = random.plan_request();
  PlanRequest& plan = std::get<PlanCall>(request.call).plan;
  plan.bin.reset();
  plan.crop_box.reset();
  plan.last_plan.reset();
  plan.failed_spots.clear();
  plan.options = {};
  const auto decoded = codec::decode_request(as_bytes(codec::encode_request(request)));
  ASSERT_TRUE(decoded) << decoded.error().message;
  EXPECT_TRUE(same(*decoded, request));

  Answer answer = random.plan_answer();
  PlanAnswer empty;
  empty.outcome = Outcome::kBinEmpty;
  empty.reason = "nothing but floor";
  answer.body = empty;
  const auto decoded_answer = codec::decode_answer(as_bytes(codec::encode_answer(answer)));
  ASSERT_TRUE(decoded_answer) << decoded_answer.error().message;
  EXPECT_TRUE(same(*decoded_answer, answer));
}

TEST(RoundTrip, TheFullestRequestFitsIntoItsEnvelope) {
  RandomMessages random(7);
  Request request = random.plan_request();
  PlanRequest& plan = std::get<PlanCall>(request.call).plan;
  const std::string longest(128, 'x');
  plan.parts.resize(kMaxPartsPerRequest, {longest, 1.5});
  LastObject object = plan.last_plan->objects.front();
  object.part_id = longest;
  plan.last_plan->objects.clear();
  for (object.id = 1000; object.id < 1000 + kMaxLastObjects; ++object.id) {
    plan.last_plan->objects.push_back(object);
  }
  FailedSpot spot = plan.failed_spots.front();
  spot.reason = longest;
  plan.failed_spots.assign(kMaxFailedSpots, spot);
  const auto decoded = codec::decode_request(as_bytes(codec::encode_request(request)));
  ASSERT_TRUE(decoded) << decoded.error().message;
  EXPECT_TRUE(same(*decoded, request));
}

TEST(RoundTrip, TheSameMessageIsTheSameBytes) {
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    EXPECT_EQ(codec::encode_request(RandomMessages(seed).plan_request()),
              codec::encode_request(RandomMessages(seed).plan_request()));
    EXPECT_EQ(codec::encode_answer(RandomMessages(seed).plan_answer()),
              codec::encode_answer(RandomMessages(seed).plan_answer()));
  }
}

TEST(RoundTrip, PosesKeepTheirRotationForEveryAngle) {
  RandomMessages random(4);
  Request request = random.plan_request();
  PlanRequest& plan = std::get<PlanCall>(request.call).plan;
  plan.bin.reset();
  plan.crop_box.reset();
  for (const Eigen::Vector3d axis :
       {Eigen::Vector3d::UnitX(), Eigen::Vector3d::UnitY(), Eigen::Vector3d::UnitZ()}) {
    for (int degrees = -360; degrees <= 360; degrees += 15) {
      const double angle_rad = degrees * std::numbers::pi / 180;
      plan.T_base_camera = Eigen::AngleAxisd(angle_rad, axis);
      const auto decoded = codec::decode_request(as_bytes(codec::encode_request(request)));
      ASSERT_TRUE(decoded) << decoded.error().message;
      ASSERT_TRUE(same(*decoded, request)) << degrees << " degrees about " << axis.transpose();
    }
  }
}

TEST(RoundTrip, NearlyUnitQuaternionsAreNormalised) {
  const std::string bytes = codec::encode_request(RandomMessages(5).plan_request());
  const auto decoded = codec::decode_request(as_bytes(
      schema::edit("Request", bytes,
                   {{"plan.request.T_base_camera.rotation", "{ w: 0 x: 1.0009 y: 0 z: 0 }"},
                    {"plan.request.bin", kClear},
                    {"plan.request.crop_box", kClear}})));
  ASSERT_TRUE(decoded) << decoded.error().message;
  const auto& T_base_camera = std::get<PlanCall>(decoded->call).plan.T_base_camera;
  const Eigen::Matrix3d half_turn = Eigen::Vector3d(1, -1, -1).asDiagonal();
  EXPECT_TRUE(T_base_camera.linear().isApprox(half_turn, 1e-15));
}

TEST(Encode, MirroredPoseIsNoRotationOnTheWireEither) {
  Request request = RandomMessages(6).plan_request();
  std::get<PlanCall>(request.call).plan.T_base_camera.linear() =
      Eigen::Vector3d(-1, 1, 1).asDiagonal();
  const auto decoded = codec::decode_request(as_bytes(codec::encode_request(request)));
  ASSERT_FALSE(decoded);
  EXPECT_NE(decoded.error().message.find("plan.request.T_base_camera.rotation"), std::string::npos);
}

TEST(Encode, CodesThatOnlyClientsMakeAreNotSent) {
  Answer answer = RandomMessages(8).refusal();
  answer.code = Code::kUnavailable;
  EXPECT_THROW(codec::encode_answer(answer), std::invalid_argument);
}

TEST(Encode, BytesThatAreNoUtf8BecomeReplacementCharacters) {
  const std::string foreign = "caf\xe9 \xff\xfe \xed\xa0\x80 \xc0\xaf caf\xc3\xa9";
  Answer refusal = RandomMessages(8).refusal();
  refusal.message = foreign;
  const auto decoded = codec::decode_answer(as_bytes(codec::encode_answer(refusal)));
  ASSERT_TRUE(decoded) << decoded.error().message;
  const std::string& message = decoded->message;
  EXPECT_EQ(message.find("caf\xef\xbf\xbd "), 0u) << message;
  EXPECT_NE(message.find("caf\xc3\xa9"), std::string::npos) << message;

  Answer answer = RandomMessages(9).plan_answer();
  auto& plan = std::get<PlanAnswer>(answer.body);
  plan.reason = plan.server.build = foreign;
  plan.warnings = {"as it was", foreign};
  plan.timings = {{foreign, 1}};
  const auto decoded_plan = codec::decode_answer(as_bytes(codec::encode_answer(answer)));
  ASSERT_TRUE(decoded_plan) << decoded_plan.error().message;
  const auto& got = std::get<PlanAnswer>(decoded_plan->body);
  EXPECT_EQ(got.warnings, (std::vector<std::string>{"as it was", message}));
  EXPECT_EQ(got.timings.at(0).stage, message);
  EXPECT_EQ(got.reason, message);
  EXPECT_EQ(got.server.build, message);
}

TEST(Decode, UnknownFieldsOfALaterVersionAreIgnored) {
  const Request request = RandomMessages(7).plan_request();
  const std::string bytes = codec::encode_request(request) + "\xc2\x3e\x03new";  // field 1000
  const auto decoded = codec::decode_request(as_bytes(bytes));
  ASSERT_TRUE(decoded) << decoded.error().message;
  EXPECT_TRUE(same(*decoded, request));
}

}  // namespace
}  // namespace graspd::testing
