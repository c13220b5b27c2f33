#include <gmock/gmock.h>
#include <mrpt/io/CFileGZOutputStream.h>
#include <mrpt/obs/CObservation3DRangeScan.h>
#include <mrpt/obs/CObservationIMU.h>
#include <mrpt/obs/CSensoryFrame.h>
#include <mrpt/serialization/CArchive.h>

#include <algorithm>
#include <fstream>

#include "graspd/recordings/rawlog.hpp"
#include "temporary_folder.hpp"

namespace graspd::testing {
namespace {

using ::testing::HasSubstr;

DepthFrame random_frame(unsigned seed, int width_px = 64, int height_px = 48) {
  DepthFrame frame{{width_px, height_px, 365.5, 366.25, 31.1, 24.9, {}}, 0.001, {}};
  std::uint32_t state = seed;
  for (int i = 0; i < width_px * height_px; ++i) {
    state = state * 1664525 + 1013904223;
    frame.depth.push_back(static_cast<std::uint16_t>(state >> 16));
  }
  return frame;
}

void expect_equal(const DepthFrame& a, const DepthFrame& b) {
  EXPECT_EQ(a.camera.width_px, b.camera.width_px);
  EXPECT_EQ(a.camera.height_px, b.camera.height_px);
  EXPECT_EQ(a.camera.fx_px, b.camera.fx_px);
  EXPECT_EQ(a.camera.fy_px, b.camera.fy_px);
  EXPECT_EQ(a.camera.cx_px, b.camera.cx_px);
  EXPECT_EQ(a.camera.cy_px, b.camera.cy_px);
  EXPECT_EQ(a.camera.distortion, b.camera.distortion);
  EXPECT_EQ(a.depth_scale_m, b.depth_scale_m);
  EXPECT_EQ(a.depth, b.depth);
}

class RawlogTest : public ::testing::Test {
 protected:
  void write(const std::vector<DepthFrame>& frames) const {
    auto writer = RawlogWriter::create(path);
    ASSERT_TRUE(writer) << writer.error().message;
    double stamp_s = 1.6e9;
    for (const DepthFrame& frame : frames) ASSERT_TRUE(writer->add(frame, stamp_s += 1.0 / 30));
  }

  /// All frames up to the end or the first error.
  std::pair<std::vector<DepthFrame>, std::string> read_all() const {
    std::vector<DepthFrame> frames;
    auto reader = RawlogReader::open(path);
    if (!reader) return {frames, reader.error().message};
    while (true) {
      auto frame = reader->next();
      if (!frame) {
        const auto again = reader->next();
        EXPECT_FALSE(again) << "an error does not go away";
        return {frames, frame.error().message};
      }
      if (!*frame) return {frames, ""};
      frames.push_back((*frame)->frame);
    }
  }

  std::string bytes() const {
    std::ifstream file(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
  }

  TemporaryFolder folder;
  std::filesystem::path path = folder.path() / "frames.rawlog";
};

TEST_F(RawlogTest, FramesIntrinsicsDistortionAndScaleComeBack) {
  std::vector<DepthFrame> frames{random_frame(1), random_frame(2, 512, 424), random_frame(3)};
  frames[0].camera.distortion = {0.0905, -0.268, 0.001, -0.0002, 0.095};
  frames[1].depth_scale_m = 0.0001;
  frames[2].depth_scale_m = 0.00025;
  write(frames);
  const auto [read, error] = read_all();
  EXPECT_EQ(error, "");
  ASSERT_EQ(read.size(), frames.size());
  for (std::size_t i = 0; i < read.size(); ++i) expect_equal(read[i], frames[i]);
}

TEST_F(RawlogTest, WhatWasAskedAndAnsweredComesBackWithItsFrame) {
  Eigen::Isometry3d T_base_camera = Eigen::Isometry3d::Identity();
  T_base_camera.translation() << 0.4, -0.1, 0.9;
  T_base_camera.rotate(Eigen::AngleAxisd(3, Eigen::Vector3d(1, 0.1, 0).normalized()));
  auto writer = RawlogWriter::create(path);
  ASSERT_TRUE(writer->add({random_frame(1), 1.25, T_base_camera, "first", "its answer"}));
  ASSERT_TRUE(writer->add({random_frame(2), 2.5, std::nullopt, "first"}));
  ASSERT_TRUE(writer->add({random_frame(3), 3.75, std::nullopt, "second"}));
  ASSERT_TRUE(writer->add({random_frame(4), 5}));
  ASSERT_TRUE(writer->finish());
  auto reader = RawlogReader::open(path);
  const auto read = [&] { return reader->next().value().value(); };
  const RecordedFrame first = read();
  EXPECT_EQ(first.stamp_s, 1.25);
  ASSERT_TRUE(first.T_base_camera);
  EXPECT_TRUE(first.T_base_camera->isApprox(T_base_camera, 1e-12));
  EXPECT_EQ(first.request, "first");
  EXPECT_EQ(first.answer, "its answer");
  const RecordedFrame second = read();
  EXPECT_EQ(second.request, "first");
  EXPECT_EQ(second.answer, "");
  EXPECT_FALSE(second.T_base_camera);
  EXPECT_EQ(read().request, "second");
  EXPECT_EQ(read().request, "");
}

TEST_F(RawlogTest, WhatWasAddedCanBeReadBeforeTheFileIsFinished) {
  auto writer = RawlogWriter::create(path);
  for (unsigned i = 0; i < 3; ++i) {
    ASSERT_TRUE(writer->add(random_frame(i), i));
    const auto [frames, error] = read_all();
    EXPECT_EQ(frames.size(), i + 1);
    EXPECT_THAT(error, HasSubstr("cut short"));
  }
}

TEST_F(RawlogTest, AFullDiskIsSaid) {
  auto writer = RawlogWriter::create("/dev/full");
  ASSERT_TRUE(writer);
  const auto refused = writer->add(random_frame(1, 512, 424), 1);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, Code::kInternal);
  EXPECT_THAT(refused.error().message, HasSubstr("after 0 frames"));
}

long resident_kib() {
  std::ifstream status("/proc/self/status");
  for (std::string line; std::getline(status, line);) {
    if (line.starts_with("VmRSS:")) return std::stol(line.substr(6));
  }
  return 0;
}

TEST_F(RawlogTest, ALargeFileIsReadFrameByFrame) {
  // Half a gigabyte: gzip files put behind one another are one file.
  DepthFrame frame = random_frame(1, 512, 424);
  std::ranges::fill(frame.depth, 700);
  write(std::vector<DepthFrame>(24, frame));
  const std::string once = bytes();
  std::ofstream file(path, std::ios::app | std::ios::binary);
  for (int i = 1; i < 50; ++i) file << once;
  file.close();
  auto reader = RawlogReader::open(path);
  std::size_t frames_n = 0;
  long most_kib = 0;
  long first_kib = 0;
  while (const auto next = reader->next().value()) {
    if (++frames_n == 10) first_kib = resident_kib();
    if (frames_n % 100 == 0) most_kib = std::max(most_kib, resident_kib());
  }
  EXPECT_EQ(frames_n, 1200u);
  EXPECT_LT(most_kib - first_kib, 16 * 1024);
}

TEST_F(RawlogTest, TheSameFramesMakeTheSameBytes) {
  write({random_frame(1), random_frame(2)});
  const std::string first = bytes();
  write({random_frame(1), random_frame(2)});
  EXPECT_EQ(bytes(), first);
}

TEST_F(RawlogTest, AnEmptyRecordingHasNoFrames) {
  write({});
  const auto [frames, error] = read_all();
  EXPECT_EQ(error, "");
  EXPECT_TRUE(frames.empty());
}

TEST_F(RawlogTest, ACutFileGivesWhatIsThereAndSaysWhereItBroke) {
  const std::vector<DepthFrame> frames{random_frame(1), random_frame(2), random_frame(3)};
  write(frames);
  const std::string whole = bytes();
  std::size_t fewest = frames.size(), most = 0;
  for (int twentieth = 1; twentieth < 20; ++twentieth) {
    folder.write("frames.rawlog", whole.substr(0, whole.size() * twentieth / 20));
    const auto [read, error] = read_all();
    ASSERT_LT(read.size(), frames.size()) << twentieth;
    for (std::size_t i = 0; i < read.size(); ++i) expect_equal(read[i], frames[i]);
    EXPECT_THAT(error, HasSubstr(path.string()));
    EXPECT_THAT(error, HasSubstr(fmt::format("after {} frames", read.size())));
    EXPECT_THAT(error, HasSubstr("cut short or damaged"));
    fewest = std::min(fewest, read.size());
    most = std::max(most, read.size());
  }
  EXPECT_EQ(fewest, 0u);
  EXPECT_EQ(most, 2u);
}

TEST_F(RawlogTest, ADamagedFileNeverGivesAWrongFrameInSilence) {
  const std::vector<DepthFrame> frames{random_frame(1), random_frame(2), random_frame(3)};
  write(frames);
  const std::string whole = bytes();
  for (std::size_t at = 0; at < whole.size(); at += 97) {
    std::string damaged = whole;
    damaged[at] = static_cast<char>(damaged[at] ^ 0x10);
    folder.write("frames.rawlog", damaged);
    const auto [read, error] = read_all();
    EXPECT_LE(read.size(), frames.size());
    if (!error.empty()) continue;
    // Some header bytes mean nothing to the data.
    ASSERT_EQ(read.size(), frames.size()) << "byte " << at;
    for (std::size_t i = 0; i < read.size(); ++i) expect_equal(read[i], frames[i]);
  }
}

TEST_F(RawlogTest, OtherObservationsArePassedOverAndSensoryFramesOpened) {
  {
    mrpt::io::CFileGZOutputStream stream(path.string());
    auto archive = mrpt::serialization::archiveFrom(stream);
    archive << mrpt::obs::CObservationIMU();
    mrpt::obs::CSensoryFrame sensory;
    sensory.insert(mrpt::obs::CObservationIMU::Create());
    auto scan = mrpt::obs::CObservation3DRangeScan::Create();
    scan->hasRangeImage = true;
    scan->rangeImage_setSize(2, 3);
    scan->rangeImage.fill(700);
    scan->cameraParams.setIntrinsicParamsFromValues(300, 300, 1, 1);
    scan->cameraParams.ncols = 3;
    scan->cameraParams.nrows = 2;
    sensory.insert(scan);
    archive << sensory;
  }
  const auto [frames, error] = read_all();
  EXPECT_EQ(error, "");
  ASSERT_EQ(frames.size(), 1u);
  EXPECT_EQ(frames[0].depth, std::vector<std::uint16_t>(6, 700));
  EXPECT_EQ(frames[0].camera.width_px, 3);
}

TEST_F(RawlogTest, RangesAlongTheRaysAreRefused) {
  {
    mrpt::io::CFileGZOutputStream stream(path.string());
    mrpt::obs::CObservation3DRangeScan scan;
    scan.hasRangeImage = true;
    scan.range_is_depth = false;
    scan.rangeImage_setSize(2, 3);
    scan.cameraParams.ncols = 3;
    scan.cameraParams.nrows = 2;
    mrpt::serialization::archiveFrom(stream) << scan;
  }
  EXPECT_THAT(read_all().second, HasSubstr("ranges along the rays"));
}

TEST_F(RawlogTest, FilesThatAreNoRawlogAreNamed) {
  EXPECT_THAT(read_all().second, HasSubstr("there is no such rawlog"));
  folder.write("frames.rawlog", "This is a text, and by no means a recording of anything.\n");
  EXPECT_THAT(read_all().second, HasSubstr("after 0 frames"));
  EXPECT_FALSE(RawlogReader::open(folder.path()));
}

TEST_F(RawlogTest, AFolderThatIsNotThereCantBeWrittenInto) {
  const auto writer = RawlogWriter::create(folder.path() / "no" / "such" / "folder.rawlog");
  ASSERT_FALSE(writer);
  EXPECT_THAT(writer.error().message, HasSubstr("folder.rawlog"));
}

TEST_F(RawlogTest, AnInvalidFrameIsRefused) {
  auto writer = RawlogWriter::create(path);
  ASSERT_TRUE(writer);
  DepthFrame frame = random_frame(1);
  frame.depth.pop_back();
  EXPECT_FALSE(writer->add(frame, 0));
}

}  // namespace
}  // namespace graspd::testing
