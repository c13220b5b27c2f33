#include <gmock/gmock.h>

#include <fstream>

#include "client_support.hpp"
#include "graspd/codec/codec.hpp"
#include "graspd/recorded/answers_file.hpp"
#include "graspd/recorded/questions.hpp"
#include "graspd/recordings/rawlog.hpp"
#include "temporary_folder.hpp"

namespace graspd::recorded {
namespace {

using graspd::testing::TemporaryFolder;
using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

class RecordedFiles : public ::testing::Test {
 protected:
  static FlightRecord flight(const std::string& cell, const PlanRequest& request,
                             const Answer& answer) {
    const auto frame = codec::encode_frame(example_frame(), DepthEncoding::kRaw);
    FlightRecord flight;
    flight.cell = cell;
    flight.server = {"build", "catalogue", "config"};
    flight.request =
        codec::encode_request({.cell = cell, .call = PlanCall{frame.description, request}});
    flight.depth_image.assign(reinterpret_cast<const char*>(frame.payload.data()),
                              frame.payload.size());
    flight.answer = codec::encode_answer(answer);
    return flight;
  }
  static std::string bytes_of(const FlightRecord& flight) { return codec::encode_flight(flight); }
  std::filesystem::path write_rawlog(const std::vector<RecordedFrame>& frames) const {
    const auto path = folder_.path() / "frames.rawlog";
    auto rawlog = RawlogWriter::create(path);
    for (const RecordedFrame& frame : frames) EXPECT_TRUE(rawlog->add(frame));
    return path;
  }
  /// Names of all questions, and the error they end with.
  static std::pair<std::vector<std::string>, std::string> names(Questions& questions) {
    std::vector<std::string> names;
    while (true) {
      auto question = questions.next();
      if (!question) return {names, question.error().message};
      if (!*question) return {names, ""};
      names.push_back((*question)->name);
    }
  }
  static std::string refusal(const Result<std::unique_ptr<Questions>>& questions) {
    return questions ? names(**questions).second : questions.error().message;
  }

  TemporaryFolder folder_;
};

TEST_F(RecordedFiles, FlightsComeInTheOrderOfTheirTimeWhateverTheirCell) {
  const std::string bytes =
      bytes_of(flight("a", example_request(), {.message = "", .body = PlanAnswer{}}));
  folder_.write("a/2026-01-03_x.flight", bytes);
  folder_.write("b/2026-01-02_x.flight", bytes);
  folder_.write("a/2026-01-01_x.flight", bytes);
  folder_.write("a/2026-01-04_x.flight.part", "unfinished");
  const auto questions = open_questions(folder_.path());
  ASSERT_TRUE(questions);
  const auto [all, error] = names(**questions);
  EXPECT_EQ(error, "");
  EXPECT_THAT(
      all, ElementsAre("a/2026-01-01_x.flight", "b/2026-01-02_x.flight", "a/2026-01-03_x.flight"));
  EXPECT_THAT(names(**open_flights_after(folder_.path(), "b/2026-01-02_x.flight")).first,
              ElementsAre("a/2026-01-03_x.flight"));
  EXPECT_THAT(names(**open_flights_after(folder_.path(), "a/2026-01-03_x.flight")).first,
              ElementsAre());
}

TEST_F(RecordedFiles, AFlightSaysWhatWasAskedAndAnswered) {
  const PlanRequest request = example_request({"tee"});
  const auto file = folder_.write(
      "x.flight",
      bytes_of(flight("cell", request, {.code = Code::kBusy, .message = "later", .body = {}})));
  const auto question = (*open_questions(file))->next();
  ASSERT_TRUE(question && *question);
  EXPECT_EQ((*question)->asked.cell, "cell");
  const auto& answer = (*question)->answered;
  ASSERT_TRUE(answer && !*answer);
  EXPECT_EQ(answer->error().code, Code::kBusy);
}

TEST_F(RecordedFiles, ADamagedFlightIsNamed) {
  folder_.write("x.flight", "this is no flight record");
  EXPECT_THAT(refusal(open_questions(folder_.path())),
              AllOf(HasSubstr("x.flight"), HasSubstr("no flight record")));
  EXPECT_THAT(refusal(open_questions(folder_.path() / "no_such.flight")), HasSubstr("there is no"));
}

TEST_F(RecordedFiles, AFolderWithoutFlightsIsNamed) {
  EXPECT_THAT(refusal(open_questions(folder_.path())), HasSubstr("there is no flight record"));
}

TEST_F(RecordedFiles, ARawlogSaysWhatWasAskedWithEachFrameToTheBit) {
  PlanRequest request = example_request({"tee"});
  request.T_base_camera.rotate(Eigen::AngleAxisd(0.1, Eigen::Vector3d(1, 2, 3).normalized()));
  PlanAnswer answer;
  answer.server.build = "then";
  const auto path = write_rawlog(
      {{example_frame(), 1.5, request.T_base_camera, codec::to_json(request, false),
        codec::to_json(answer, false)},
       {example_frame(), 2.5, request.T_base_camera, codec::to_json(request, false), ""}});
  const auto questions = open_questions(path);
  ASSERT_TRUE(questions);
  const auto first = (*questions)->next();
  const auto second = (*questions)->next();
  ASSERT_TRUE(first && *first && second && *second);
  const auto frame = codec::encode_frame(example_frame(), DepthEncoding::kRaw);
  const std::string envelope =
      codec::encode_request({.cell = "", .call = PlanCall{frame.description, request}});
  EXPECT_EQ((*first)->asked.request, envelope);
  EXPECT_EQ((*second)->asked.request, envelope);
  EXPECT_EQ((*second)->asked.stamp_s, 2.5);
  ASSERT_TRUE((*first)->answered && *(*first)->answered);
  EXPECT_EQ((**(*first)->answered).server.build, "then");
  EXPECT_FALSE((*second)->answered) << "the answer was to the first frame";
}

TEST_F(RecordedFiles, ARawlogWithoutRequestsIsAskedWithTheOneGiven) {
  const auto path = write_rawlog({{example_frame(), 1}});
  EXPECT_THAT(refusal(open_questions(path)),
              AllOf(HasSubstr("frames.rawlog: frame 0"), HasSubstr("--camera, --cell and --part")));
  EXPECT_EQ(refusal(open_questions(path, AskWith{example_request(), example_frame().camera})), "");
}

TEST_F(RecordedFiles, ARecordingOfAnotherCameraIsRefused) {
  const auto path = write_rawlog({{example_frame(), 1}});
  CameraIntrinsics other = example_frame().camera;
  other.fx_px *= 1.2;
  EXPECT_THAT(refusal(open_questions(path, AskWith{example_request(), other})),
              AllOf(HasSubstr("another camera"), HasSubstr("focal length 24.0 px")));
  EXPECT_THAT(
      refusal(open_questions(path, AskWith{example_request(), example_frame(20, 12).camera})),
      HasSubstr("16 × 12 pixels"));
}

TEST_F(RecordedFiles, ARequestInARawlogThatIsNoneIsNamed) {
  const auto path = write_rawlog({{example_frame(), 1, std::nullopt, "{\"parts\": 5}"}});
  EXPECT_THAT(refusal(open_questions(path)),
              HasSubstr("frame 0: this is no graspd.v1.PlanRequest"));
}

TEST_F(RecordedFiles, AnswersComeBackAsTheyWere) {
  const auto path = folder_.path() / "answers.jsonl";
  PlanAnswer answer;
  answer.outcome = Outcome::kBinEmpty;
  answer.reason = "\"empty\"\n";
  {
    auto writer = AnswersWriter::create(path);
    ASSERT_TRUE(writer);
    ASSERT_TRUE(writer->add({"frame 0", 17, answer}));
    ASSERT_TRUE(writer->add({"frame 1", 18, fail(Code::kBusy, "later")}));
  }
  auto reader = AnswersReader::open(path);
  ASSERT_TRUE(reader);
  const auto first = reader->next();
  const auto second = reader->next();
  ASSERT_TRUE(first && *first && second && *second);
  EXPECT_EQ((*first)->name, "frame 0");
  EXPECT_EQ((*first)->depth_crc32, 17u);
  ASSERT_TRUE((*first)->answer);
  EXPECT_EQ((*first)->answer->reason, answer.reason);
  EXPECT_EQ((*second)->answer.error().code, Code::kBusy);
  EXPECT_EQ((*second)->answer.error().message, "later");
  EXPECT_FALSE(*reader->next());
}

TEST_F(RecordedFiles, AnswersThatAreNoneAreNamedWithTheirLine) {
  const auto path = folder_.path() / "answers.jsonl";
  ASSERT_TRUE(AnswersWriter::create(path)->add({"frame 0", 17, PlanAnswer{}}));
  std::ofstream(path, std::ios::app) << R"({"name": "frame 1", "depth_cr)";
  auto reader = AnswersReader::open(path);
  EXPECT_TRUE(reader->next());
  const auto cut = reader->next();
  ASSERT_FALSE(cut);
  EXPECT_THAT(cut.error().message, HasSubstr("answers.jsonl:2: "));
  EXPECT_FALSE(AnswersReader::open(folder_.path() / "no_such.jsonl"));
  EXPECT_FALSE(AnswersWriter::create(folder_.path() / "no" / "folder.jsonl"));
  const auto full = AnswersWriter::create("/dev/full")->add({"frame 0", 17, PlanAnswer{}});
  ASSERT_FALSE(full);
  EXPECT_EQ(full.error().code, Code::kInternal);
}

}  // namespace
}  // namespace graspd::recorded
