#include "graspd/recordings/rawlog.hpp"

#include <mrpt/obs/CSensoryFrame.h>
#include <mrpt/serialization/CArchive.h>

#include <deque>
#include <utility>

#include "gzip_stream.hpp"
#include "observation.hpp"

namespace graspd {

struct RawlogWriter::Impl {
  explicit Impl(std::filesystem::path file)
      : path(std::move(file)), stream(path, GzipStream::Mode::kWrite) {}

  tl::unexpected<Error> fail_writing() const {
    return invalid("{}: writing failed; is the disk full?", path.string());
  }

  std::filesystem::path path;
  GzipStream stream;
};

RawlogWriter::RawlogWriter(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
RawlogWriter::RawlogWriter(RawlogWriter&&) noexcept = default;
RawlogWriter& RawlogWriter::operator=(RawlogWriter&&) noexcept = default;
RawlogWriter::~RawlogWriter() = default;

Result<RawlogWriter> RawlogWriter::create(const std::filesystem::path& path) {
  auto impl = std::make_unique<Impl>(path);
  if (!impl->stream.is_open()) {
    return invalid("{}: can't be written; does its folder exist, and may you write there?",
                   path.string());
  }
  return RawlogWriter(std::move(impl));
}

Result<void> RawlogWriter::add(const DepthFrame& frame, double stamp_s) {
  if (const auto valid = validate(frame); !valid) return tl::unexpected(valid.error());
  auto observation = to_observation(frame);
  observation.timestamp = mrpt::Clock::fromDouble(stamp_s);
  try {
    mrpt::serialization::archiveFrom(impl_->stream) << observation;
  } catch (const std::exception&) {
    return impl_->fail_writing();
  }
  return {};
}

Result<void> RawlogWriter::finish() {
  if (!impl_->stream.close()) return impl_->fail_writing();
  return {};
}

struct RawlogReader::Impl {
  explicit Impl(std::filesystem::path file)
      : path(std::move(file)), stream(path, GzipStream::Mode::kRead) {}

  std::filesystem::path path;
  GzipStream stream;
  std::deque<mrpt::obs::CObservation3DRangeScan::Ptr> waiting;  ///< read, not yet given out
  std::size_t given_n = 0;
  std::optional<Error> broken;

  tl::unexpected<Error> fail_here(std::string_view what) {
    broken = Error{Code::kInvalidArgument,
                   fmt::format("{}: broken after {} frames, at byte {} of {}: {}", path.string(),
                               given_n, stream.getPosition(), stream.getTotalBytesCount(), what)};
    return tl::unexpected(*broken);
  }

  void collect(const mrpt::serialization::CSerializable::Ptr& object) {
    using mrpt::obs::CObservation3DRangeScan;
    if (const auto scan = std::dynamic_pointer_cast<CObservation3DRangeScan>(object)) {
      waiting.push_back(scan);
    } else if (const auto frame = std::dynamic_pointer_cast<mrpt::obs::CSensoryFrame>(object)) {
      for (const auto& observation : *frame) collect(observation);
    }
  }
};

RawlogReader::RawlogReader(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
RawlogReader::RawlogReader(RawlogReader&&) noexcept = default;
RawlogReader& RawlogReader::operator=(RawlogReader&&) noexcept = default;
RawlogReader::~RawlogReader() = default;

Result<RawlogReader> RawlogReader::open(const std::filesystem::path& path) {
  std::error_code error;
  if (!std::filesystem::is_regular_file(path, error)) {
    return invalid("{}: there is no such rawlog", path.string());
  }
  auto impl = std::make_unique<Impl>(path);
  if (!impl->stream.is_open()) {
    return invalid("{}: can't be read; may you read it?", path.string());
  }
  return RawlogReader(std::move(impl));
}

Result<std::optional<DepthFrame>> RawlogReader::next() {
  if (impl_->broken) return tl::unexpected(*impl_->broken);
  auto archive = mrpt::serialization::archiveFrom(impl_->stream);
  while (impl_->waiting.empty()) {
    try {
      impl_->collect(archive.ReadObject());
    } catch (const std::exception& e) {
      const bool ended = dynamic_cast<const mrpt::serialization::CExceptionEOF*>(&e) != nullptr;
      if (ended && impl_->stream.good()) return std::nullopt;
      return impl_->fail_here("the file is cut short or damaged; record it again");
    }
  }
  auto frame = to_frame(*impl_->waiting.front());
  impl_->waiting.pop_front();
  if (!frame) return impl_->fail_here(frame.error().message);
  ++impl_->given_n;
  return std::move(*frame);
}

}  // namespace graspd
