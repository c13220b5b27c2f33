#include "graspd/recordings/rawlog.hpp"

#include <cmath>

#include "sources.hpp"

namespace graspd::recorded {
namespace {

// Of the focal length: further apart, it is another camera, not a better calibration.
constexpr double kCalibrationShare = 0.05;

bool is_other_camera(const CameraIntrinsics& a, const CameraIntrinsics& b) {
  return a.width_px != b.width_px || a.height_px != b.height_px ||
         std::abs(a.fx_px - b.fx_px) > kCalibrationShare * b.fx_px;
}

std::string text_of(const CameraIntrinsics& camera) {
  return fmt::format("{} × {} pixels, focal length {:.1f} px", camera.width_px, camera.height_px,
                     camera.fx_px);
}

class Rawlog final : public Questions {
 public:
  Rawlog(std::filesystem::path path, RawlogReader reader, std::optional<AskWith> ask_with)
      : path_(std::move(path)), reader_(std::move(reader)), ask_with_(std::move(ask_with)) {}

  Result<std::optional<Question>> next() override {
    auto recorded = reader_.next();
    if (!recorded) return tl::unexpected(recorded.error());
    if (!*recorded) return std::nullopt;
    auto question = question_of(**recorded);
    if (!question) {
      return invalid("{}: frame {}: {}", path_.string(), given_n_, question.error().message);
    }
    ++given_n_;
    return question;
  }

 private:
  Result<Question> question_of(const RecordedFrame& recorded) const {
    const auto encoded = codec::encode_frame(recorded.frame, DepthEncoding::kRaw);
    auto envelope = envelope_of(recorded, encoded.description);
    if (!envelope) return tl::unexpected(envelope.error());
    Question question;
    question.name = fmt::format("frame {}", given_n_);
    question.asked.stamp_s = recorded.stamp_s;
    question.asked.request = *std::move(envelope);
    question.asked.depth_image.assign(reinterpret_cast<const char*>(encoded.payload.data()),
                                      encoded.payload.size());
    if (recorded.answer.empty()) return question;
    auto answer = codec::plan_answer_from_json(recorded.answer);
    if (!answer) return tl::unexpected(answer.error());
    question.answered = std::move(answer);
    return question;
  }

  Result<std::string> envelope_of(const RecordedFrame& recorded,
                                  const FrameDescription& frame) const {
    if (ask_with_) {
      if (ask_with_->camera && is_other_camera(frame.camera, *ask_with_->camera)) {
        return invalid(
            "it was recorded by another camera ({}) than the one that is calibrated ({}); take "
            "that "
            "one's calibration",
            text_of(frame.camera), text_of(*ask_with_->camera));
      }
      return codec::encode_request({.cell = "", .call = PlanCall{frame, ask_with_->request}});
    }
    if (recorded.request.empty()) {
      return invalid(
          "there is no request beside it that says what to look for and where; say it (grasp "
          "replay: --camera, --cell and --part; grasp load: FILE=PART)");
    }
    return codec::request_from_json(recorded.request, frame);
  }

  std::filesystem::path path_;
  RawlogReader reader_;
  std::optional<AskWith> ask_with_;
  std::size_t given_n_ = 0;
};

}  // namespace

Result<std::unique_ptr<Questions>> open_rawlog(const std::filesystem::path& path,
                                               std::optional<AskWith> ask_with) {
  auto reader = RawlogReader::open(path);
  if (!reader) return tl::unexpected(reader.error());
  return std::make_unique<Rawlog>(path, *std::move(reader), std::move(ask_with));
}

}  // namespace graspd::recorded
