#include "graspd/recordings/rawlog.hpp"

#include <mrpt/obs/CObservationComment.h>
#include <mrpt/obs/CSensoryFrame.h>
#include <mrpt/serialization/CArchive.h>

#include <deque>
#include <utility>

#include "gzip_stream.hpp"
#include "observation.hpp"

namespace graspd {
namespace {

using mrpt::obs::CObservation3DRangeScan;
using mrpt::obs::CObservationComment;

// Comments that begin with these are of the frames after them: a request holds until another one
// comes, an answer is the next frame's. (MRPT writes no label of a comment.)
constexpr std::string_view kRequest = "graspd request ";
constexpr std::string_view kAnswer = "graspd answer ";

/// MRPT's sensors look along x, with y to the left and z up.
Eigen::Isometry3d T_camera_sensor() {
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  T.linear() << 0, -1, 0, 0, 0, -1, 1, 0, 0;
  return T;
}

CObservationComment comment(std::string_view kind, const std::string& text, double stamp_s) {
  CObservationComment comment;
  comment.text.append(kind).append(text);
  comment.timestamp = mrpt::Clock::fromDouble(stamp_s);
  return comment;
}

}  // namespace

struct RawlogWriter::Impl {
  explicit Impl(std::filesystem::path file)
      : path(std::move(file)), stream(path, GzipStream::Mode::kWrite) {}

  tl::unexpected<Error> fail_writing() const {
    return fail(Code::kInternal, "{}: writing failed after {} frames; is the disk full?",
                path.string(), added_n);
  }

  std::filesystem::path path;
  GzipStream stream;
  std::string request;  ///< the last one written
  std::size_t added_n = 0;
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

Result<void> RawlogWriter::add(const RecordedFrame& recorded) {
  if (const auto valid = validate(recorded.frame); !valid) return tl::unexpected(valid.error());
  auto observation = to_observation(recorded.frame);
  observation.timestamp = mrpt::Clock::fromDouble(recorded.stamp_s);
  if (recorded.T_base_camera) {
    const Eigen::Isometry3d T_base_sensor = *recorded.T_base_camera * T_camera_sensor();
    observation.sensorPose =
        mrpt::poses::CPose3D(mrpt::math::CMatrixDouble44(Eigen::Matrix4d(T_base_sensor.matrix())));
  }
  try {
    auto archive = mrpt::serialization::archiveFrom(impl_->stream);
    if (recorded.request != impl_->request) {
      archive << comment(kRequest, recorded.request, recorded.stamp_s);
      impl_->request = recorded.request;
    }
    if (!recorded.answer.empty()) {
      archive << comment(kAnswer, recorded.answer, recorded.stamp_s);
    }
    archive << observation;
  } catch (const std::exception&) {
    return impl_->fail_writing();
  }
  if (!impl_->stream.flush()) return impl_->fail_writing();
  ++impl_->added_n;
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
  std::deque<CObservation3DRangeScan::Ptr> waiting;  ///< read, not yet given out
  std::string request;                               ///< of the next frame
  std::string answer;
  std::size_t given_n = 0;
  std::optional<Error> broken;

  tl::unexpected<Error> fail_here(std::string_view what) {
    broken = Error{Code::kInvalidArgument,
                   fmt::format("{}: broken after {} frames, at byte {} of {}: {}", path.string(),
                               given_n, stream.getPosition(), stream.getTotalBytesCount(), what)};
    return tl::unexpected(*broken);
  }

  void collect(const mrpt::serialization::CSerializable::Ptr& object) {
    if (const auto scan = std::dynamic_pointer_cast<CObservation3DRangeScan>(object)) {
      waiting.push_back(scan);
    } else if (const auto frame = std::dynamic_pointer_cast<mrpt::obs::CSensoryFrame>(object)) {
      for (const auto& observation : *frame) collect(observation);
    } else if (const auto text = std::dynamic_pointer_cast<CObservationComment>(object)) {
      const std::string_view all = text->text;
      if (all.starts_with(kRequest)) request = all.substr(kRequest.size());
      if (all.starts_with(kAnswer)) answer = all.substr(kAnswer.size());
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
    return invalid("{}: there is no such rawlog, nor a folder of that name; is the path right?",
                   path.string());
  }
  auto impl = std::make_unique<Impl>(path);
  if (!impl->stream.is_open()) {
    return invalid("{}: can't be read; may you read it?", path.string());
  }
  return RawlogReader(std::move(impl));
}

Result<std::optional<RecordedFrame>> RawlogReader::next() {
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
  const CObservation3DRangeScan::Ptr scan = impl_->waiting.front();
  impl_->waiting.pop_front();
  auto frame = to_frame(*scan);
  if (!frame) return impl_->fail_here(frame.error().message);
  ++impl_->given_n;
  RecordedFrame recorded{*std::move(frame), mrpt::Clock::toDouble(scan->timestamp)};
  const Eigen::Matrix4d T_base_sensor =
      scan->sensorPose.getHomogeneousMatrixVal<mrpt::math::CMatrixDouble44>().asEigen();
  if (!T_base_sensor.isIdentity(0)) {
    recorded.T_base_camera = Eigen::Isometry3d(T_base_sensor) * T_camera_sensor().inverse();
  }
  recorded.request = impl_->request;
  recorded.answer = std::exchange(impl_->answer, {});
  return recorded;
}

}  // namespace graspd
