#include "load_recording.hpp"

#include <filesystem>
#include <functional>
#include <span>
#include <sstream>

#include "graspd/codec/codec.hpp"
#include "graspd/formats/bop.hpp"
#include "graspd/formats/cell.hpp"
#include "graspd/recorded/questions.hpp"

namespace graspd::program {
namespace {

namespace fs = std::filesystem;

// 43 MB of raw Kinect v2 frames, however long the recording.
constexpr std::size_t kMostFrames_n = 100;

struct FrameAsked {
  DepthFrame frame;
  PlanRequest request;
  std::optional<double> stamp_s = std::nullopt;
};
/// The next frame and what is asked of it, or nothing after the last one.
using NextFrame = std::function<Result<std::optional<FrameAsked>>()>;

/// "RECORDING=tee,elbow", or "RECORDING" where it says what was asked.
struct Named {
  fs::path path;
  std::vector<std::string> parts;
};

Named parse(const std::string& what) {
  const auto equals = what.rfind('=');
  Named named{what.substr(0, equals), {}};
  std::istringstream words(equals == std::string::npos ? "" : what.substr(equals + 1));
  for (std::string part; std::getline(words, part, ',');) named.parts.push_back(part);
  return named;
}

Result<NextFrame> open_scene(const Named& named) {
  if (named.parts.empty()) {
    return invalid("{0}: a scene does not say which parts to ask for: say them, as in {0}=tee",
                   named.path.string());
  }
  auto scene = BopScene::open(named.path);
  if (!scene) return tl::unexpected(scene.error());
  return NextFrame([scene = *std::move(scene), parts = named.parts,
                    next = std::size_t{0}]() mutable -> Result<std::optional<FrameAsked>> {
    if (next == scene.image_ids().size()) return std::nullopt;
    auto image = scene.read(scene.image_ids()[next]);
    if (!image) return invalid("{} (after {} frames)", image.error().message, next);
    ++next;
    PlanRequest request = request_for(*image, parts);
    return FrameAsked{std::move(image->frame), std::move(request)};
  });
}

Result<FrameAsked> frame_asked(const FlightRecord& asked) {
  const auto bytes_of = [](const std::string& text) { return std::as_bytes(std::span(text)); };
  auto request = codec::decode_request(bytes_of(asked.request));
  if (!request) return tl::unexpected(request.error());
  auto* const call = std::get_if<PlanCall>(&request->call);
  if (call == nullptr) return invalid("it is no plan that was asked for");
  auto frame = codec::decode_frame(call->frame, bytes_of(asked.depth_image));
  if (!frame) return tl::unexpected(frame.error());
  call->plan.options.record = false;  // the server's flight recorder is for cells that are real
  return FrameAsked{*std::move(frame), std::move(call->plan), asked.stamp_s};
}

/// A rawlog, or what a flight recorder kept. Parts that are named are what is asked for, of a
/// rawlog by a camera that looks down.
Result<NextFrame> open_recording(const Named& named) {
  PlanRequest request;
  request.T_base_camera = looking_down();
  for (const std::string& id : named.parts) request.parts.push_back({id, 0});
  std::optional<recorded::AskWith> ask_with;
  if (!named.parts.empty()) ask_with = recorded::AskWith{request, std::nullopt};
  auto questions = recorded::open_questions(named.path, std::move(ask_with));
  if (!questions) return tl::unexpected(questions.error());
  return NextFrame([questions = std::shared_ptr(*std::move(questions)),  // a function can be copied
                    parts = request.parts]() -> Result<std::optional<FrameAsked>> {
    const auto question = questions->next();
    if (!question) return tl::unexpected(question.error());
    if (!*question) return std::nullopt;
    auto asked = frame_asked((*question)->asked);
    if (!asked) return invalid("{}: {}", (*question)->name, asked.error().message);
    if (!parts.empty()) asked->request.parts = parts;
    return *std::move(asked);
  });
}

}  // namespace

Result<LoadRecording> read_load_recording(const std::string& what, DepthEncoding encoding) {
  const Named named = parse(what);
  const bool is_scene = fs::exists(named.path / "scene_camera.json");
  const auto next = is_scene ? open_scene(named) : open_recording(named);
  if (!next) return tl::unexpected(next.error());

  LoadRecording recording;
  while (recording.plans.size() < kMostFrames_n) {
    const auto asked = (*next)();
    if (asked && !*asked) break;
    const auto plan = asked ? client::prepare((*asked)->frame, (*asked)->request, encoding)
                            : Result<client::PreparedPlan>(tl::unexpected(asked.error()));
    if (!plan) {
      if (recording.plans.empty()) return tl::unexpected(plan.error());
      recording.note = fmt::format("{}; the {} frames before are used", plan.error().message,
                                   recording.plans.size());
      return recording;
    }
    recording.plans.push_back(*plan);
    if ((*asked)->stamp_s) recording.stamps_s.push_back(*(*asked)->stamp_s);
  }
  if (recording.plans.empty()) return invalid("{}: there is no frame in it", named.path.string());
  if (recording.plans.size() == kMostFrames_n) {
    recording.note =
        fmt::format("{}: the first {} frames are used", named.path.string(), kMostFrames_n);
  }
  return recording;
}

}  // namespace graspd::program
