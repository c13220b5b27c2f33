#include <Driver/OniDriverAPI.h>
#include <stdlib.h>

#include <atomic>
#include <chrono>
#include <cstring>
#include <string>
#include <thread>

/// A depth camera for OpenNI2 that is none: the library loads it as it loads a real one's driver.
/// GRASPD_CAMERA says what it does wrong: none, absent, vga_only, wrong_size, silent, dies, or
/// eager: a frame is ready whenever one is asked for, as with OpenNI2's own driver of recordings.
///
/// The pixel in column u reads 600 + u mm, but for the first one, which counts the frames.
namespace {

using oni::driver::DeviceBase;
using oni::driver::DriverBase;
using oni::driver::StreamBase;

std::string fault() {
  const char* text = getenv("GRASPD_CAMERA");
  return text == nullptr ? "none" : text;
}

OniVideoMode mode(int width_px, int height_px) {
  return {ONI_PIXEL_FORMAT_DEPTH_1_MM, width_px, height_px, 30};
}

class Stream final : public StreamBase {
 public:
  ~Stream() override { stop(); }

  OniStatus start() override {
    runs_ = fault() != "silent";
    if (fault() != "eager") thread_ = std::thread([this] { run(); });
    return ONI_STATUS_OK;
  }
  void stop() override {
    runs_ = false;
    if (thread_.joinable()) thread_.join();
  }

  OniBool isPropertySupported(int property) override {
    return property == ONI_STREAM_PROPERTY_VIDEO_MODE;
  }
  OniStatus getProperty(int property, void* data, int* size) override {
    if (property != ONI_STREAM_PROPERTY_VIDEO_MODE) return ONI_STATUS_NOT_SUPPORTED;
    std::memcpy(data, &mode_, sizeof(mode_));
    *size = sizeof(mode_);
    return ONI_STATUS_OK;
  }
  OniStatus setProperty(int property, const void* data, int /*size*/) override {
    if (property != ONI_STREAM_PROPERTY_VIDEO_MODE) return ONI_STATUS_NOT_SUPPORTED;
    std::memcpy(&mode_, data, sizeof(mode_));
    return ONI_STATUS_OK;
  }

  void give() {
    const int number = ++given_n_;
    OniFrame* frame = getServices().acquireFrame();
    if (frame == nullptr) return;
    const int height_px = fault() == "wrong_size" ? mode_.resolutionY / 2 : mode_.resolutionY;
    frame->sensorType = ONI_SENSOR_DEPTH;
    frame->frameIndex = number;
    frame->timestamp = static_cast<std::uint64_t>(number) * 33333;
    frame->videoMode = mode_;
    frame->width = mode_.resolutionX;
    frame->height = height_px;
    frame->stride = mode_.resolutionX * 2;
    frame->dataSize = frame->stride * height_px;
    frame->croppingEnabled = FALSE;
    auto* depth = static_cast<std::uint16_t*>(frame->data);
    for (int v = 0; v < height_px; ++v) {
      for (int u = 0; u < frame->width; ++u) *depth++ = static_cast<std::uint16_t>(600 + u);
    }
    *static_cast<std::uint16_t*>(frame->data) = static_cast<std::uint16_t>(number);
    raiseNewFrame(frame);
    getServices().releaseFrame(frame);
  }

 private:
  void run() {
    while (runs_ && !(fault() == "dies" && given_n_ == 4)) {
      give();
      std::this_thread::sleep_for(std::chrono::microseconds(33333));
    }
  }

  OniVideoMode mode_ = mode(640, 480);  // as the Kinect v2's own driver starts
  std::atomic<bool> runs_ = false;
  int given_n_ = 0;
  std::thread thread_;
};

class Device final : public DeviceBase {
 public:
  Device() {
    if (fault() == "vga_only") sensor_.numSupportedVideoModes = 1;
  }
  OniStatus getSensorInfoList(OniSensorInfo** sensors, int* sensors_n) override {
    *sensors = &sensor_;
    *sensors_n = 1;
    return ONI_STATUS_OK;
  }
  StreamBase* createStream(OniSensorType sensor) override {
    if (sensor != ONI_SENSOR_DEPTH) return nullptr;
    return stream_ = new Stream;
  }
  void destroyStream(StreamBase* stream) override {
    delete stream;
    stream_ = nullptr;
  }
  /// OpenNI2 asks so whenever somebody waits.
  OniStatus tryManualTrigger() override {
    if (fault() == "eager" && stream_ != nullptr) stream_->give();
    return ONI_STATUS_OK;
  }

 private:
  OniVideoMode modes_[2] = {mode(640, 480), mode(512, 424)};
  OniSensorInfo sensor_{ONI_SENSOR_DEPTH, 2, modes_};
  Stream* stream_ = nullptr;
};

class Driver final : public DriverBase {
 public:
  explicit Driver(OniDriverServices* services) : DriverBase(services) {}

  OniStatus initialize(oni::driver::DeviceConnectedCallback connected,
                       oni::driver::DeviceDisconnectedCallback disconnected,
                       oni::driver::DeviceStateChangedCallback changed, void* cookie) override {
    DriverBase::initialize(connected, disconnected, changed, cookie);
    OniDeviceInfo info{"graspd-test-camera", "graspd", "camera of the tests", 0, 0};
    if (fault() != "absent") deviceConnected(&info);
    return ONI_STATUS_OK;
  }
  DeviceBase* deviceOpen(const char* /*uri*/, const char* /*mode*/) override { return new Device; }
  void deviceClose(DeviceBase* device) override { delete device; }
  void shutdown() override {}
};

}  // namespace

#define XN_NEW(type, services) new type(services)
#define XN_DELETE(pointer) delete pointer
// NOLINTNEXTLINE(readability-identifier-naming): what OpenNI2 looks for
ONI_EXPORT_DRIVER(Driver)
