#include <gmock/gmock.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <numbers>
#include <ostream>

#include "graspd/eval/evaluate.hpp"
#include "graspd/perception/planner.hpp"
#include "graspd/simulation/bin_mesh.hpp"
#include "graspd/simulation/scene.hpp"
#include "part_test_support.hpp"

/// Our own parts in a simulated bin, through the whole planner: where segments are not parts, and
/// where parts of several types lie together.
namespace graspd {
namespace {

using Eigen::Vector3d;

const Vector3d kBin_m(0.30, 0.24, 0.12);
const Eigen::Quaterniond kFlat = Eigen::Quaterniond::Identity();
const Eigen::Quaterniond kOnItsSide(Eigen::AngleAxisd(std::numbers::pi / 2, Vector3d::UnitY()));

const parts::Catalogue& own_parts() {
  static const parts::Catalogue catalogue =
      parts::Catalogue::load(parts::own_parts_folder()).value();
  return catalogue;
}

struct Lying {
  std::string part_id;
  Eigen::Isometry3d T_bin_part;
};

/// On the floor, its origin over (x, y).
Lying lying(const std::string& id, const Eigen::Quaterniond& R, double turn_rad, double x_m,
            double y_m) {
  Eigen::Isometry3d T(Eigen::AngleAxisd(turn_rad, Vector3d::UnitZ()) * R);
  double lowest_m = 1;
  for (const Eigen::Vector3f& p_m : own_parts().find(id)->mesh.vertices_m) {
    lowest_m = std::min(lowest_m, (T * p_m.cast<double>()).z());
  }
  T.pretranslate(Vector3d(x_m, y_m, -lowest_m));
  return {id, T};
}

BopImage seen(const std::vector<Lying>& parts, const std::vector<parts::Mesh>& others) {
  const simulation::KinectV2Parameters sensor;
  const Eigen::Isometry3d T_bin_camera = simulation::camera_over_bin(0.75, 0);
  const Eigen::Isometry3d T_camera_bin = T_bin_camera.inverse();
  std::vector<simulation::SceneObject> scene;
  for (const Lying& part : parts) {
    scene.push_back({&own_parts().find(part.part_id)->mesh, T_camera_bin * part.T_bin_part});
  }
  const parts::Mesh bin = simulation::bin_mesh(kBin_m, 0.005);
  scene.push_back({&bin, T_camera_bin});
  for (const parts::Mesh& other : others) scene.push_back({&other, T_camera_bin});
  const simulation::Walls walls{T_camera_bin, kBin_m};
  const auto truth = simulation::render(sensor.camera, scene);
  const auto fractions = simulation::visible_fractions(truth, scene);
  BopImage image;
  image.frame = simulation::observe(scene, sensor, /*seed=*/1, &walls);
  image.bin = BopBin{T_camera_bin, kBin_m};
  image.T_world_camera = T_bin_camera;
  image.instance = Image16{sensor.camera.width_px, sensor.camera.height_px, {}};
  for (const auto object : truth.object) {
    const bool is_part = object >= 0 && object < std::ssize(parts);
    image.instance->values.push_back(is_part ? static_cast<std::uint16_t>(object + 1) : 0);
  }
  for (std::size_t i = 0; i < parts.size(); ++i) {
    image.truth.push_back(
        {own_parts().find(parts[i].part_id)->bop_obj_id, scene[i].T_camera_object, fractions[i]});
  }
  return image;
}

eval::ImageReport report_of(const BopImage& image, const std::vector<std::string>& asked) {
  return eval::evaluate_image(image, 0, eval::request_for(image, own_parts(), asked), own_parts(),
                              {})
      .value();
}

struct Pose {
  std::string part_id;
  Eigen::Quaterniond R;
  double apart_m;  ///< two of these that touch
};

void PrintTo(const Pose& pose, std::ostream* out) { *out << pose.part_id; }

class SimulatedBins : public testing::TestWithParam<Pose> {};

TEST_P(SimulatedBins, APartInPiecesIsOnePart) {
  const auto& [id, R, _] = GetParam();
  const parts::Mesh bar = parts::box_mesh({0.014F, -0.12F, 0.075F}, {0.012F, 0.24F, 0.01F});
  const eval::ImageReport report = report_of(seen({lying(id, R, 0.3, 0.02, 0.01)}, {bar}), {id});
  ASSERT_GE(report.segmentation->over_segmented_n, 1) << "the bar cuts it in two";
  EXPECT_EQ(report.poses->right_n(), 1);
  EXPECT_EQ(report.poses->answers_n(), 1);
}

TEST_P(SimulatedBins, TwoPartsInOneSegmentAreTwo) {
  const auto& [id, R, apart_m] = GetParam();
  const BopImage image =
      seen({lying(id, R, 0.3, 0.02, 0.01), lying(id, R, 0.6, 0.02, 0.01 + apart_m)}, {});
  const eval::ImageReport report = report_of(image, {id});
  ASSERT_EQ(report.segmentation->under_segmented_n, 1) << "they touch";
  EXPECT_EQ(report.poses->right_n(), 2);
  EXPECT_EQ(report.poses->answers_n(), 2);
}

INSTANTIATE_TEST_SUITE_P(Parts, SimulatedBins,
                         testing::Values(Pose{"straight_pipe", kOnItsSide, 0.03},
                                         Pose{"tee", kFlat, 0.04}, Pose{"elbow", kFlat, 0.04}),
                         [](const auto& test) { return test.param.part_id; });

TEST(SimulatedBinsTest, EachOfSeveralTypesIsFoundAsWhatItIs) {
  const BopImage image =
      seen({lying("tee", kFlat, 0.3, -0.08, 0.05), lying("tee", kFlat, 1.9, 0.0, 0.06),
            lying("straight_pipe", kOnItsSide, 0.8, 0.08, 0.05),
            lying("elbow", kFlat, 2.5, -0.08, -0.05), lying("flanged_ring", kFlat, 0, 0.0, -0.05),
            lying("hex_bolt", kOnItsSide, 0.2, 0.08, -0.05)},
           {});
  const eval::ImageReport report =
      report_of(image, {"tee", "straight_pipe", "elbow", "flanged_ring", "hex_bolt"});
  std::vector<std::string> found;
  for (const Object& object : report.answer.objects) found.push_back(object.part_id);
  EXPECT_THAT(found, testing::UnorderedElementsAre("tee", "tee", "straight_pipe", "elbow",
                                                   "flanged_ring", "hex_bolt"));
  EXPECT_GE(report.poses->right_n(), 5) << "the turn of a bolt's head is one of a pixel";
}

TEST(SimulatedBinsTest, APileGivesTheSameBitsWhateverTheThreads) {
  simulation::SceneOptions options;
  options.parts = {{"tee", 20}, {"l_bracket", 15}};
  const BopImage image = simulation::SceneMaker::create(own_parts(), options)->make(0).value();
  const PlanRequest request = eval::request_for(image, own_parts(), {"tee", "l_bracket"});
  const auto numbers_with = [&](std::size_t threads_n) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads_n);
    const PlanAnswer answer = perception::plan(image.frame, request, own_parts(), {}).value();
    std::vector<double> numbers;
    const auto add = [&](const Eigen::Isometry3d& T, std::initializer_list<double> others) {
      numbers.insert(numbers.end(), T.matrix().data(), T.matrix().data() + 16);
      numbers.insert(numbers.end(), others);
    };
    for (const Object& object : answer.objects) {
      add(object.T_base_part, {object.score, object.visible_fraction, object.grs.grs});
    }
    for (const Grasp& grasp : answer.grasps) {
      add(grasp.T_base_grasp, {grasp.opening_width_m, grasp.room_m, grasp.score});
    }
    return numbers;
  };
  const auto one = numbers_with(1);
  ASSERT_GT(one.size(), 10U * 19U) << "of ten objects and more";
  for (const std::size_t threads_n : {1U, 2U, 4U}) {
    EXPECT_EQ(numbers_with(threads_n), one) << "to the bit, with " << threads_n << " threads";
  }
}

}  // namespace
}  // namespace graspd
