#include "flight_recorder.hpp"

#include <fmt/chrono.h>

#include <chrono>

#include "graspd/codec/codec.hpp"
#include "graspd/types/flight.hpp"

namespace graspd::service {
namespace {

using SystemClock = std::chrono::system_clock;

// The largest are 45 MB in all.
constexpr std::size_t kMostWaiting_n = 32;

std::uint64_t bytes_of_mib(std::uint32_t mib) { return static_cast<std::uint64_t>(mib) << 20; }

}  // namespace

FlightRecorder::FlightRecorder(const FlightRecorderConfig& config)
    : folder_(config.folder, {config.per_cell_n, bytes_of_mib(config.max_mib)}) {
  if (!config.folder.empty()) thread_ = std::thread([this] { run(); });
}

FlightRecorder::~FlightRecorder() {
  if (!is_on()) return;
  {
    const std::lock_guard lock(mutex_);
    stop_ = true;
  }
  wake_.notify_one();
  thread_.join();
}

std::string FlightRecorder::name_of(const RequestId& id) {
  const auto now = std::chrono::time_point_cast<std::chrono::microseconds>(SystemClock::now());
  const auto micros = now.time_since_epoch().count() % 1'000'000;
  return fmt::format("{:%Y-%m-%dT%H-%M-%S}.{:06}Z_{}{}", fmt::gmtime(SystemClock::to_time_t(now)),
                     micros, hexadecimal(id), kFlightExtension);
}

void FlightRecorder::keep(std::string name, Flight flight) {
  const double stamp_s =
      std::chrono::duration<double>(SystemClock::now().time_since_epoch()).count();
  const std::lock_guard lock(mutex_);
  if (waiting_.size() >= kMostWaiting_n) {
    lost(fmt::format("the disk is slower than the requests: {} wait to be written",
                     waiting_.size()));
    return;
  }
  waiting_.push_back({std::move(name), stamp_s, std::move(flight)});
  wake_.notify_one();
}

std::vector<std::string> FlightRecorder::news() {
  const std::lock_guard lock(mutex_);
  return std::exchange(news_, {});
}

void FlightRecorder::run() {
  std::unique_lock lock(mutex_);
  while (true) {
    wake_.wait(lock, [this] { return stop_ || !waiting_.empty(); });
    if (waiting_.empty()) return;
    const Waiting next = std::move(waiting_.front());
    waiting_.pop_front();
    lock.unlock();
    const auto written = write(next);
    lock.lock();
    written ? kept() : lost(written.error().message);
  }
}

Result<void> FlightRecorder::write(const Waiting& waiting) {
  const Flight& flight = waiting.flight;
  const std::string bytes = codec::encode_flight({.cell = flight.cell,
                                                  .stamp_s = waiting.stamp_s,
                                                  .server = flight.server,
                                                  .request = flight.request.to_string(),
                                                  .depth_image = flight.depth_image.to_string(),
                                                  .answer = flight.answer.to_string()});
  return folder_.add(flight.cell, waiting.name, bytes);
}

void FlightRecorder::lost(const std::string& why) {
  if (lost_n_++ == 0) {
    news_.push_back(
        fmt::format("flight_recorder: {}; records are lost from now on, answers are not", why));
  }
}

void FlightRecorder::kept() {
  if (lost_n_ == 0) return;
  news_.push_back(fmt::format("flight_recorder: records are kept again; {} were lost",
                              std::exchange(lost_n_, 0)));
}

}  // namespace graspd::service
