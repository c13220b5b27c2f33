#include "graspd/formats/yaml.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "graspd/formats/cell.hpp"
#include "temporary_folder.hpp"

namespace graspd {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

class Yaml : public ::testing::Test {
 protected:
  /// Reads `text` as a small configuration and gives the faults, or "".
  std::string faults(const std::string& text) {
    YamlDocument document(folder_.write("file.yaml", text));
    YamlMap root = document.root();
    root.required("name", name_);
    root.optional("count_n", count_n_);
    root.optional("width_m", width_m_);
    root.optional("on", on_);
    root.optional("point_m", point_m_);
    root.optional("T", T_);
    root.optional_enum("order", order_);
    YamlMap inner = root.map("inner");
    inner.optional("depth_m", depth_m_);
    for (YamlMap item : root.list_of_maps("items")) {
      std::string id;
      item.required("id", id);
      ids_.push_back(id);
    }
    const auto ok = document.finish();
    return ok ? "" : ok.error().message;
  }
  testing::TemporaryFolder folder_;
  std::string name_;
  int count_n_ = 7;
  double width_m_ = 0.5;
  double depth_m_ = 0.25;
  bool on_ = false;
  Eigen::Vector3d point_m_ = Eigen::Vector3d::Zero();
  Eigen::Isometry3d T_ = Eigen::Isometry3d::Identity();
  GraspOrder order_ = GraspOrder::kServerDefault;
  std::vector<std::string> ids_;
};

TEST_F(Yaml, ReadsEveryKindOfValue) {
  EXPECT_EQ(faults("name: cell\n"
                   "count_n: 3\n"
                   "width_m: 1.5e-2\n"
                   "on: true\n"
                   "point_m: [1, 2, 3]\n"
                   "T: [[0, -1, 0, 1], [1, 0, 0, 2], [0, 0, 1, 3], [0, 0, 0, 1]]\n"
                   "order: ascending\n"
                   "inner: {depth_m: 2}\n"
                   "items: [{id: a}, {id: b}]\n"),
            "");
  EXPECT_EQ(name_, "cell");
  EXPECT_EQ(count_n_, 3);
  EXPECT_EQ(width_m_, 0.015);
  EXPECT_TRUE(on_);
  EXPECT_EQ(point_m_, Eigen::Vector3d(1, 2, 3));
  EXPECT_TRUE((T_ * Eigen::Vector3d(1, 0, 0)).isApprox(Eigen::Vector3d(1, 3, 3)));
  EXPECT_EQ(order_, GraspOrder::kAscending);
  EXPECT_EQ(depth_m_, 2);
  EXPECT_EQ(ids_, (std::vector<std::string>{"a", "b"}));
}

TEST_F(Yaml, LeavesDefaultsWhereKeysAreAbsentOrEmpty) {
  EXPECT_EQ(faults("name: cell\ncount_n:\n"), "");
  EXPECT_EQ(count_n_, 7);
  EXPECT_EQ(width_m_, 0.5);
  EXPECT_EQ(depth_m_, 0.25);
}

TEST_F(Yaml, NamesAnUnknownKeyWithItsLine) {
  EXPECT_THAT(
      faults("name: cell\nwidht_m: 1\n"),
      AllOf(HasSubstr("file.yaml:2"), HasSubstr("unknown key 'widht_m'"), HasSubstr("width_m")));
  EXPECT_THAT(faults("name: cell\ninner:\n  deep: 1\n"),
              AllOf(HasSubstr("file.yaml:3"), HasSubstr("unknown key 'deep'")));
  EXPECT_THAT(faults("name: cell\nitems: [{id: a, colour: red}]\n"), HasSubstr("'colour'"));
}

TEST_F(Yaml, CollectsEveryFaultOfAFile) {
  const std::string found =
      faults("count_n: many\nwidth_m: wide\npoint_m: [1, 2]\norder: sideways\nnew: 1\n");
  EXPECT_THAT(found, AllOf(HasSubstr("'name' is missing"), HasSubstr("file.yaml:1: 'count_n'"),
                           HasSubstr("file.yaml:2: 'width_m' must be a number"),
                           HasSubstr("file.yaml:3: 'point_m' must be a list of 3"),
                           HasSubstr("known: descending | ascending"), HasSubstr("key 'new'")));
}

TEST_F(Yaml, TakesNoNumberThatIsNotFinite) {
  EXPECT_THAT(faults("name: a\nwidth_m: .nan\n"), HasSubstr("'width_m' must be a number"));
  EXPECT_THAT(faults("name: a\nwidth_m: .inf\n"), HasSubstr("'width_m' must be a number"));
}

TEST_F(Yaml, TakesNoPoseThatIsNotOne) {
  EXPECT_THAT(faults("name: a\nT: [2, 0, 0, 0, 0, 2, 0, 0, 0, 0, 2, 0, 0, 0, 0, 1]\n"),
              HasSubstr("'T' is no pose"));
  EXPECT_THAT(faults("name: a\nT: [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, -1, 0, 0, 0, 0, 1]\n"),
              HasSubstr("'T' is no pose"));
}

TEST_F(Yaml, SaysWhatIsNoMapping) {
  EXPECT_THAT(faults("- a\n- b\n"), HasSubstr("must be a mapping"));
  EXPECT_THAT(faults("name: a\ninner: 3\n"), HasSubstr("'inner' must be a mapping"));
  EXPECT_THAT(faults("name: a\nitems: 3\n"), HasSubstr("'items' must be a list"));
  EXPECT_THAT(faults("name: [unclosed\n"), AllOf(HasSubstr("file.yaml:"), HasSubstr("not YAML")));
}

TEST_F(Yaml, SaysThatAFileIsMissing) {
  YamlDocument document(folder_.path() / "none.yaml");
  std::string name;
  document.root().required("name", name);
  const auto ok = document.finish();
  ASSERT_FALSE(ok);
  EXPECT_EQ(ok.error().code, Code::kInvalidArgument);
  EXPECT_THAT(ok.error().message, HasSubstr("none.yaml: can't be read"));
  EXPECT_THAT(ok.error().message, ::testing::Not(HasSubstr("missing"))) << "one fault is enough";
}

constexpr const char* kOpenCvCamera =
    "%YAML:1.0\n---\n"
    "image_width: 512\nimage_height: 424\n"
    "camera_matrix: !!opencv-matrix\n  rows: 3\n  cols: 3\n  dt: d\n"
    "  data: [365.5, 0, 255, 0, 365.6, 205, 0, 0, 1]\n"
    "distortion_coefficients: !!opencv-matrix\n  rows: 1\n  cols: 5\n  dt: d\n"
    "  data: [0.09, -0.27, 0.001, 0.002, 0.095]\n";

TEST_F(Yaml, ReadsACalibrationAsOpenCvWritesIt) {
  const auto calibration = read_camera(folder_.write("camera.yaml", kOpenCvCamera));
  ASSERT_TRUE(calibration) << calibration.error().message;
  EXPECT_EQ(calibration->camera.width_px, 512);
  EXPECT_EQ(calibration->camera.fy_px, 365.6);
  EXPECT_EQ(calibration->camera.cx_px, 255);
  EXPECT_EQ(calibration->camera.distortion[4], 0.095);
  EXPECT_EQ(calibration->depth_scale_m, 0.001);
  EXPECT_FALSE(calibration->T_base_camera);
}

TEST_F(Yaml, NamesWhatIsWrongWithACalibration) {
  std::string text = kOpenCvCamera;
  text.replace(text.find("365.5"), 5, "0.000");
  const auto zero = read_camera(folder_.write("camera.yaml", text));
  ASSERT_FALSE(zero);
  EXPECT_THAT(zero.error().message, AllOf(HasSubstr("camera.yaml"), HasSubstr("fx_px")));
  text = kOpenCvCamera;
  text.replace(text.find("rows: 3"), 7, "rows: 2");
  const auto shape = read_camera(folder_.write("camera.yaml", text));
  ASSERT_FALSE(shape);
  EXPECT_THAT(shape.error().message, HasSubstr("2 × 3 but has 9 numbers"));
}

TEST_F(Yaml, ReadsACell) {
  const auto cell = read_cell(
      folder_.write("cell.yaml",
                    "bin:\n  T_base_bin: [1, 0, 0, 0.3, 0, 1, 0, 0, 0, 0, 1, 0.02, 0, 0, 0, 1]\n"
                    "  inner_size_m: [0.3, 0.2, 0.1]\n"
                    "gripper:\n  max_opening_m: 0.06\n"));
  ASSERT_TRUE(cell) << cell.error().message;
  ASSERT_TRUE(cell->bin);
  EXPECT_EQ(cell->bin->inner_size_m, Eigen::Vector3d(0.3, 0.2, 0.1));
  EXPECT_EQ(cell->gripper.max_opening_m, 0.06);
  EXPECT_EQ(cell->gripper.standoff_m, Gripper{}.standoff_m);
}

}  // namespace
}  // namespace graspd
