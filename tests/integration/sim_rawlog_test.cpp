#include <gmock/gmock.h>
#include <mrpt/io/CFileGZOutputStream.h>
#include <mrpt/obs/CObservation3DRangeScan.h>
#include <mrpt/obs/CObservationIMU.h>
#include <mrpt/obs/CSensoryFrame.h>
#include <mrpt/serialization/CArchive.h>

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
      frames.push_back(**frame);
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
