#include "graspd/openni2/openni2_camera.hpp"

#include <OpenNI.h>
#include <fmt/ranges.h>

#include <cstring>
#include <set>

#include "graspd/formats/mirror.hpp"

namespace graspd::openni2 {
namespace {

/// What OpenNI2 says of its last error, in one line.
std::string last_error() {
  std::string text = openni::OpenNI::getExtendedError();
  while (!text.empty() && std::isspace(static_cast<unsigned char>(text.back()))) text.pop_back();
  for (char& c : text) c = c == '\n' || c == '\t' ? ' ' : c;
  return text.empty() ? "no reason is given" : text;
}

/// OpenNI2 counts how often it was set up.
class Session {
 public:
  Session() : status_(openni::OpenNI::initialize()) {}
  ~Session() {
    if (is_up()) openni::OpenNI::shutdown();
  }
  Session(const Session&) = delete;
  Session& operator=(const Session&) = delete;
  bool is_up() const { return status_ == openni::STATUS_OK; }

 private:
  openni::Status status_;
};

std::string name_of(const openni::VideoMode& mode) {
  return fmt::format("{}x{} at {}", mode.getResolutionX(), mode.getResolutionY(), mode.getFps());
}

std::optional<double> depth_scale_m(openni::PixelFormat format) {
  if (format == openni::PIXEL_FORMAT_DEPTH_1_MM) return 0.001;
  if (format == openni::PIXEL_FORMAT_DEPTH_100_UM) return 0.0001;
  return std::nullopt;
}

class OpenNi2Camera final : public agent::Camera {
 public:
  OpenNi2Camera(const CameraOptions& options, agent::Clock& clock)
      : options_(options), clock_(clock) {
    if (options.depth_correction) corrector_.emplace(*options.depth_correction, options.camera);
  }
  ~OpenNi2Camera() override {
    stream_.stop();
    stream_.destroy();
    device_.close();
  }

  Result<void> start() {
    if (!session_.is_up())
      return fail(Code::kUnavailable, "OpenNI2 does not start: {}", last_error());
    const char* uri = options_.uri.empty() ? openni::ANY_DEVICE : options_.uri.c_str();
    if (device_.open(uri) != openni::STATUS_OK) {
      return fail(Code::kUnavailable,
                  "no depth camera{}: {}; is it plugged in, and is its driver in OpenNI2's folder?",
                  options_.uri.empty() ? "" : fmt::format(" at '{}'", options_.uri), last_error());
    }
    if (stream_.create(device_, openni::SENSOR_DEPTH) != openni::STATUS_OK) {
      return fail(Code::kUnavailable, "the camera gives no depth: {}", last_error());
    }
    if (auto ok = set_mode(); !ok) return ok;
    // Some drivers can swap left and right themselves; once is enough.
    if (stream_.isPropertySupported(openni::STREAM_PROPERTY_MIRRORING)) {
      stream_.setMirroringEnabled(false);
    }
    if (stream_.start() != openni::STATUS_OK) {
      return fail(Code::kUnavailable, "the camera's depth does not start: {}", last_error());
    }
    return {};
  }

  Result<std::optional<DepthFrame>> next() override {
    openni::VideoFrameRef frame;
    // What was waiting is older than this call. OpenNI2 keeps one frame, and some of its drivers
    // make a new one as soon as it is read: no loop.
    if (wait(std::chrono::milliseconds(0))) static_cast<void>(stream_.readFrame(&frame));
    for (int i = 0; i < 2; ++i) {
      if (!wait(options_.timeout) || stream_.readFrame(&frame) != openni::STATUS_OK) {
        return fail(Code::kUnavailable,
                    "no frame of the camera for {:.1f} s: is it still plugged in?",
                    std::chrono::duration<double>(options_.timeout).count());
      }
    }
    const auto arrival = clock_.now();
    return to_depth_frame(frame, arrival - std::chrono::nanoseconds(std::chrono::seconds(1)) /
                                               options_.frames_per_second);
  }

 private:
  /// The mode with the intrinsics' size and whole millimetres, or finer.
  Result<void> set_mode() {
    std::set<std::string> known;
    const auto& modes = stream_.getSensorInfo().getSupportedVideoModes();
    for (int i = 0; i < modes.getSize(); ++i) {
      known.insert(name_of(modes[i]));
      if (modes[i].getResolutionX() != options_.camera.width_px ||
          modes[i].getResolutionY() != options_.camera.height_px ||
          modes[i].getFps() != options_.frames_per_second ||
          !depth_scale_m(modes[i].getPixelFormat())) {
        continue;
      }
      if (stream_.setVideoMode(modes[i]) == openni::STATUS_OK) return {};
      return fail(Code::kUnavailable, "the camera refuses {}: {}", name_of(modes[i]), last_error());
    }
    return fail(Code::kUnavailable, "the camera has no depth mode {}x{} at {}; it has {}",
                options_.camera.width_px, options_.camera.height_px, options_.frames_per_second,
                fmt::join(known, ", "));
  }

  bool wait(std::chrono::milliseconds timeout) {
    openni::VideoStream* streams[] = {&stream_};
    int ready = 0;
    return openni::OpenNI::waitForAnyStream(streams, 1, &ready,
                                            static_cast<int>(timeout.count())) == openni::STATUS_OK;
  }

  Result<std::optional<DepthFrame>> to_depth_frame(const openni::VideoFrameRef& frame,
                                                   std::chrono::nanoseconds stamp) const {
    const int width_px = frame.getWidth();
    const int height_px = frame.getHeight();
    const auto scale_m = depth_scale_m(frame.getVideoMode().getPixelFormat());
    if (width_px != options_.camera.width_px || height_px != options_.camera.height_px ||
        !scale_m) {
      return fail(Code::kUnavailable,
                  "the camera gives {} × {} pixels, though {} × {} were asked for", width_px,
                  height_px, options_.camera.width_px, options_.camera.height_px);
    }
    const auto width = static_cast<std::size_t>(width_px);
    DepthFrame depth{options_.camera, *scale_m, {}, stamp};
    depth.depth.resize(width * static_cast<std::size_t>(height_px));
    const auto* rows = static_cast<const std::uint8_t*>(frame.getData());
    for (std::size_t v = 0; v < static_cast<std::size_t>(height_px); ++v) {
      std::memcpy(&depth.depth[v * width],
                  rows + v * static_cast<std::size_t>(frame.getStrideInBytes()), width * 2);
    }
    if (options_.is_mirrored) mirror_rows(depth.depth, width_px);
    if (corrector_) corrector_->correct(depth);
    return depth;
  }

  CameraOptions options_;
  agent::Clock& clock_;
  std::optional<DepthCorrector> corrector_;
  Session session_;
  openni::Device device_;
  openni::VideoStream stream_;
};

}  // namespace

Result<std::unique_ptr<agent::Camera>> open_camera(const CameraOptions& options,
                                                   agent::Clock& clock) {
  if (auto ok = validate(options.camera); !ok) return tl::unexpected(ok.error());
  auto camera = std::make_unique<OpenNi2Camera>(options, clock);
  if (auto ok = camera->start(); !ok) return tl::unexpected(ok.error());
  return camera;
}

}  // namespace graspd::openni2
