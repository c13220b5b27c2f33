#include <gtest/gtest.h>

#include "graspd/codec/codec.hpp"
#include "random_messages.hpp"
#include "schema.hpp"

/// Bytes that nobody meant. Whatever comes in, the decoders say so in a sentence, or find it valid.
namespace graspd::testing {
namespace {

/// \returns whether they were taken.
bool decode_both(const std::string& bytes) {
  const auto request = codec::decode_request(as_bytes(bytes));
  const auto answer = codec::decode_answer(as_bytes(bytes));
  codec::salvage_request_id(as_bytes(bytes));
  if (!request) {
    EXPECT_TRUE(request.error().code == Code::kInvalidArgument ||
                request.error().code == Code::kUnsupportedVersion);
    EXPECT_GT(request.error().message.size(), 20u);
    EXPECT_LT(request.error().message.size(), 500u);
  }
  if (!answer) {
    EXPECT_EQ(answer.error().code, Code::kInternal);
    EXPECT_GT(answer.error().message.size(), 20u);
    EXPECT_LT(answer.error().message.size(), 500u);
  }
  return request || answer;
}

std::vector<std::string> valid_envelopes() {
  RandomMessages random(1);
  return {codec::encode_request(random.plan_request()),
          codec::encode_request(random.health_request()),
          codec::encode_answer(random.plan_answer()), codec::encode_answer(random.health_answer()),
          codec::encode_answer(random.refusal())};
}

TEST(Garbage, TruncationAtEveryByte) {
  for (const std::string& envelope : valid_envelopes()) {
    ASSERT_TRUE(decode_both(envelope));
    int refused_n = 0;
    for (std::size_t size = 0; size < envelope.size(); ++size) {
      if (!decode_both(envelope.substr(0, size))) ++refused_n;
    }
    // The cut may fall between two fields that nothing depends on, but hardly ever does.
    EXPECT_GT(refused_n, static_cast<int>(envelope.size() * 9 / 10));
  }
}

TEST(Garbage, RandomBytes) {
  RandomMessages random(2);
  std::mt19937 rng(2);
  for (int i = 0; i < 100'000; ++i) {
    std::string bytes(static_cast<std::size_t>(random.integer(0, 64)), '\0');
    for (char& byte : bytes) byte = static_cast<char>(rng());
    ASSERT_FALSE(decode_both(bytes));
  }
}

TEST(Garbage, ValidEnvelopesWithSomeBytesChanged) {
  RandomMessages random(3);
  std::mt19937 rng(3);
  const auto envelopes = valid_envelopes();
  int refused_n = 0;
  for (int i = 0; i < 20'000; ++i) {
    std::string bytes = envelopes[static_cast<std::size_t>(i) % envelopes.size()];
    for (int changes_n = random.integer(1, 4); changes_n > 0; --changes_n) {
      bytes[rng() % bytes.size()] = static_cast<char>(rng());
    }
    if (!decode_both(bytes)) ++refused_n;
  }
  EXPECT_GT(refused_n, 1000);
}

TEST(Garbage, EmptyEnvelopeHasNoVersion) {
  const auto request = codec::decode_request({});
  ASSERT_FALSE(request);
  EXPECT_EQ(request.error().code, Code::kUnsupportedVersion);
}

TEST(Garbage, OverSizeIsRefusedBeforeItIsParsed) {
  const std::string request = codec::encode_request(RandomMessages(4).plan_request());
  // An unknown field fills the envelope to the size.
  const auto filled_to = [&](std::size_t size) {
    const std::size_t filling = size - request.size() - 5;
    return request + "\xc2\x3e" + static_cast<char>(0x80 | (filling & 0x7f)) +
           static_cast<char>(0x80 | (filling >> 7 & 0x7f)) + static_cast<char>(filling >> 14) +
           std::string(filling, 'x');
  };
  const std::string largest = filled_to(kMaxRequestEnvelope_bytes);
  ASSERT_EQ(largest.size(), kMaxRequestEnvelope_bytes);
  EXPECT_TRUE(codec::decode_request(as_bytes(largest)));
  const auto refused = codec::decode_request(as_bytes(filled_to(kMaxRequestEnvelope_bytes + 1)));
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, Code::kInvalidArgument);
  EXPECT_NE(refused.error().message.find(fmt::format(
                "{} bytes; at most {}", kMaxRequestEnvelope_bytes + 1, kMaxRequestEnvelope_bytes)),
            std::string::npos);
  const auto refused_answer =
      codec::decode_answer(as_bytes(std::string(kMaxAnswer_bytes + 1, 'x')));
  ASSERT_FALSE(refused_answer);
  EXPECT_NE(refused_answer.error().message.find("262145 bytes; at most 262144"), std::string::npos);
}

TEST(Garbage, DeepNestingIsRefused) {
  // Groups of an unknown field, each within the last: "start group 1000" and no end.
  std::string groups;
  for (int i = 0; i < 8000; ++i) groups += "\xc3\x3e";
  EXPECT_FALSE(decode_both(groups));
}

TEST(Garbage, TextThatIsNotUtf8IsRefusedInSilence) {
  std::string bytes = codec::encode_request(RandomMessages(5).health_request());
  const std::string cell = "\x22\x02\xff\xfe";  // field 4, two bytes
  ::testing::internal::CaptureStderr();
  EXPECT_FALSE(codec::decode_request(as_bytes(bytes + cell)));
  EXPECT_EQ(::testing::internal::GetCapturedStderr(), "");
}

TEST(SalvageRequestId, FromEnvelopesThatAreRefused) {
  const Request request = RandomMessages(6).plan_request();
  const std::string bytes = codec::encode_request(request);
  const auto salvage = [](const std::string& broken) {
    EXPECT_FALSE(codec::decode_request(as_bytes(broken)));
    return codec::salvage_request_id(as_bytes(broken));
  };
  EXPECT_EQ(salvage(schema::edit("Request", bytes, {{"plan", kClear}})), request.id);
  EXPECT_EQ(salvage(schema::edit("Request", bytes, {{"protocol_version", "7"}})), request.id);
  EXPECT_EQ(salvage(bytes.substr(0, bytes.size() / 2)), request.id);
  EXPECT_EQ(salvage(bytes + std::string(kMaxRequestEnvelope_bytes, '\0')), request.id);
  EXPECT_EQ(salvage(bytes + "\xff"), request.id);
}

TEST(SalvageRequestId, IsZeroWhereThereIsNone) {
  const std::string bytes = codec::encode_request(RandomMessages(7).plan_request());
  EXPECT_EQ(codec::salvage_request_id({}), RequestId{});
  EXPECT_EQ(codec::salvage_request_id(as_bytes(std::string("depth image"))), RequestId{});
  EXPECT_EQ(codec::salvage_request_id(
                as_bytes(schema::edit("Request", bytes, {{"id", "\"fifteen bytes..\""}}))),
            RequestId{});
}

TEST(SalvageRequestId, LooksNoFurtherThanTheLargestEnvelope) {
  const std::string largest =
      "\xc2\x3e\x80\x80\x08" + std::string(kMaxRequestEnvelope_bytes, 'x');  // field 1000
  const std::string bytes = codec::encode_request(RandomMessages(8).health_request());
  EXPECT_EQ(codec::salvage_request_id(as_bytes(largest + bytes)), RequestId{});
}

}  // namespace
}  // namespace graspd::testing
