#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <random>

#include "client_support.hpp"
#include "graspd/client/client.hpp"
#include "service_raw_client.hpp"
#include "service_support.hpp"

// What is not a request, sent to a real front, with a good client beside it.
namespace graspd::service {
namespace {

using ::testing::HasSubstr;

class GarbageTest : public ::testing::Test {
 protected:
  GarbageTest() { front_.wait_ready(); }
  ~GarbageTest() override {
    const auto answer = good_.plan(example_frame(), example_request(), std::chrono::seconds(20));
    EXPECT_TRUE(answer) << "the good client was harmed: " << answer.error().message;
  }

  Error refusal(const std::vector<std::string>& frames) {
    raw_.send(frames);
    const Answer answer = raw_.receive();
    return {answer.code, answer.message};
  }

  ThreadLauncher launcher_{scripted_plan, kScriptedServer};
  RunningFront front_{scripted_config(1), launcher_};
  client::Client good_{{front_.data_endpoint}};
  RawClient raw_{front_.data_endpoint};
};

TEST_F(GarbageTest, TheUnspoiltRequestIsAnswered) {
  raw_.send(good_frames());
  const Answer answer = raw_.receive();
  EXPECT_EQ(answer.code, Code::kOk) << answer.message;
  EXPECT_EQ(answer.id, kRawId);
}

TEST_F(GarbageTest, AnEmptyFrameOfAReqSocketIsExplained) {
  auto frames = good_frames();
  frames.insert(frames.begin(), "");
  const Error error = refusal(frames);
  EXPECT_EQ(error.code, Code::kInvalidArgument);
  EXPECT_THAT(error.message, HasSubstr("DEALER"));
}

TEST_F(GarbageTest, TooManyFrames) {
  auto frames = good_frames();
  frames.resize(50, "more");
  const Error error = refusal(frames);
  EXPECT_EQ(error.code, Code::kInvalidArgument);
  EXPECT_THAT(error.message, HasSubstr("50 frames"));
}

TEST_F(GarbageTest, TheDepthImageIsMissing) {
  auto frames = good_frames();
  frames.pop_back();
  raw_.send(frames);
  const Answer answer = raw_.receive();
  EXPECT_EQ(answer.code, Code::kInvalidArgument);
  EXPECT_EQ(answer.id, kRawId);
  EXPECT_THAT(answer.message, HasSubstr("depth image"));
}

TEST_F(GarbageTest, TheDepthImageIsTruncated) {
  auto frames = good_frames();
  frames[1].resize(frames[1].size() - 2);
  const Error error = refusal(frames);
  EXPECT_EQ(error.code, Code::kInvalidArgument);
  EXPECT_THAT(error.message, HasSubstr("payload_bytes"));
}

TEST_F(GarbageTest, OneBitOfTheDepthImageIsWrong) {
  auto frames = good_frames();
  frames[1][100] ^= 4;
  const Error error = refusal(frames);
  EXPECT_EQ(error.code, Code::kInvalidArgument);
  EXPECT_THAT(error.message, ::testing::ContainsRegex("checksum|crc"));
}

TEST_F(GarbageTest, AnEnvelopeThatIsTooLargeIsNotParsed) {
  const Error error = refusal({std::string(kMaxRequestEnvelope_bytes + 1, '\x0a'), "payload"});
  EXPECT_EQ(error.code, Code::kInvalidArgument);
  EXPECT_THAT(error.message, HasSubstr(std::to_string(kMaxRequestEnvelope_bytes)));
}

TEST_F(GarbageTest, ADepthImageThatIsTooLarge) {
  auto frames = good_frames();
  frames[1] = std::string(kMaxPayload_bytes + 1, 'x');
  const Error error = refusal(frames);
  EXPECT_EQ(error.code, Code::kInvalidArgument);
  EXPECT_THAT(error.message, HasSubstr(std::to_string(kMaxPayload_bytes)));
}

TEST_F(GarbageTest, AFrameBeyondTheSocketsLimitCostsOnlyTheConnection) {
  auto frames = good_frames();
  frames[1] = std::string(4 * kMaxPayload_bytes, 'x');
  raw_.send(frames);
  // The connection is closed and made anew; then the front answers again.
  bool answered = false;
  for (int i = 0; i < 400 && !answered; ++i) {
    raw_.send(good_frames());
    answered = raw_.answered_within(std::chrono::milliseconds(50));
  }
  EXPECT_TRUE(answered);
}

TEST_F(GarbageTest, RandomBytesGetOneRefusalEach) {
  std::mt19937 random(3);
  for (int i = 0; i < 300; ++i) {
    std::vector<std::string> frames(1 + random() % 3);
    for (std::string& frame : frames) {
      frame.resize(1 + random() % 400);
      for (char& byte : frame) byte = static_cast<char>(random());
    }
    EXPECT_NE(refusal(frames).code, Code::kOk);
  }
}

TEST_F(GarbageTest, SpoiltEnvelopesGetOneAnswerEach) {
  std::mt19937 random(5);
  for (int i = 0; i < 300; ++i) {
    auto frames = good_frames();
    frames[0][random() % frames[0].size()] = static_cast<char>(random());
    if (i % 3 == 0) frames[0].resize(random() % frames[0].size() + 1);
    raw_.send(frames);
    raw_.receive();
  }
}

TEST_F(GarbageTest, AClientThatLeavesBeforeItsAnswerDoesNoHarm) {
  for (int i = 0; i < 20; ++i) raw_.send(good_frames());
  raw_.close();
}

}  // namespace
}  // namespace graspd::service
