#include <gmock/gmock.h>

#include <algorithm>
#include <chrono>
#include <mutex>
#include <random>

#include "graspd/eval/evaluate.hpp"
#include "graspd/eval/pose_error.hpp"
#include "graspd/perception/planner.hpp"
#include "graspd/simulation/scene.hpp"
#include "graspd/types/camera_model.hpp"
#include "part_test_support.hpp"

// Frames and parts that are not what they should be, through the whole planner with its default
// parameters: a named outcome in bounded time, and never a confident wrong answer.
namespace graspd::perception {
namespace {

using std::chrono::steady_clock;
using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

/// Cubes of a grid as one closed surface.
parts::Mesh cubes_mesh(const std::vector<Eigen::Vector3i>& cubes, double side_m) {
  parts::Mesh mesh;
  const auto index_of = [&](const Eigen::Vector3i& corner) {
    const Eigen::Vector3f p_m = corner.cast<float>() * static_cast<float>(side_m);
    const auto known = std::ranges::find(mesh.vertices_m, p_m) - mesh.vertices_m.begin();
    if (static_cast<std::size_t>(known) == mesh.vertices_m.size()) mesh.vertices_m.push_back(p_m);
    return static_cast<int>(known);
  };
  for (const Eigen::Vector3i& cube : cubes) {
    for (int face = 0; face < 6; ++face) {
      const Eigen::Vector3i out = (face % 2 == 0 ? 1 : -1) * Eigen::Vector3i::Unit(face / 2);
      if (std::ranges::find(cubes, Eigen::Vector3i(cube + out)) != cubes.end()) continue;
      const Eigen::Vector3i across = Eigen::Vector3i::Unit((face / 2 + 1) % 3);
      const Eigen::Vector3i up = out.cross(across);
      const Eigen::Vector3i first =
          cube + (Eigen::Vector3i::Ones() + out - across - up).cwiseMax(0) / 2;
      const int a = index_of(first), b = index_of(first + across);
      const int c = index_of(first + across + up), d = index_of(first + up);
      mesh.triangles.insert(mesh.triangles.end(), {{a, b, c}, {a, c, d}});
    }
  }
  return mesh;
}

/// Arms of three lengths at right angles: not its own mirror image.
parts::Mesh tripod_mesh(double side_m = 0.015) {
  std::vector<Eigen::Vector3i> cubes{Eigen::Vector3i::Zero()};
  for (int axis = 0; axis < 3; ++axis) {
    for (int i = 1; i <= 5 - 2 * axis; ++i) cubes.emplace_back(i * Eigen::Vector3i::Unit(axis));
  }
  return cubes_mesh(cubes, side_m);
}

void mirror(BopImage& image) {
  const auto width = static_cast<std::size_t>(image.frame.camera.width_px);
  for (auto row = image.frame.depth.begin(); row != image.frame.depth.end(); row += width) {
    std::reverse(row, row + width);
  }
  image.frame.camera.cx_px = image.frame.camera.width_px - 1 - image.frame.camera.cx_px;
}

template <class Distribution>
void fill(DepthFrame& frame, std::uint32_t seed, Distribution depth_mm) {
  std::mt19937 random(seed);
  for (auto& value : frame.depth) {
    value = static_cast<std::uint16_t>(std::lround(depth_mm(random) / 1e3 / frame.depth_scale_m));
  }
}

double best_score(const PlanAnswer& answer) {
  double best = 0;
  for (const Object& object : answer.objects) best = std::max(best, object.score);
  return best;
}

class BadFrames : public ::testing::Test {
 protected:
  parts::Catalogue catalogue_of(const std::string& id, const parts::Mesh& mesh) const {
    parts::PartDescription description;
    description.id = id;
    description.bop_obj_id = 1;
    description.mesh_file = folder_.write(id + ".stl", parts::to_stl(mesh, 1e3));
    return parts::Catalogue({make_part(description).value()});
  }
  static BopImage pile(const parts::Catalogue& catalogue, int count_n, std::uint64_t seed = 1) {
    simulation::SceneOptions options;
    options.parts = {{catalogue.parts().front().id, count_n}};
    options.seed = seed;
    return simulation::SceneMaker::create(catalogue, options)->make(0).value();
  }
  Result<PlanAnswer> try_plan(const BopImage& image, const parts::Catalogue& catalogue) const {
    // So much may pass before the planner looks at the clock.
    auto looked = steady_clock::now();
    std::mutex mutex;
    const auto look = [&] {
      const std::lock_guard lock(mutex);
      const auto now = steady_clock::now();
      EXPECT_LT(now - looked, std::chrono::seconds(1));
      looked = now;
      return false;
    };
    const PlanRequest request = eval::request_for(image, catalogue, {catalogue.parts()[0].id});
    return plan(image.frame, request, catalogue, parameters_, look);
  }
  PlanAnswer plan_of(const BopImage& image, const parts::Catalogue& catalogue) const {
    return try_plan(image, catalogue).value();
  }
  void expect_nothing(const PlanAnswer& answer) const {
    EXPECT_NE(answer.outcome, Outcome::kPlanned);
    EXPECT_THAT(answer.objects, IsEmpty());
    EXPECT_FALSE(answer.reason.empty());
  }

  parts::TestFolder folder_;
  Parameters parameters_;
};

TEST_F(BadFrames, InNoiseOverTheWholeRangeThereIsNothing) {
  const parts::Catalogue catalogue = catalogue_of("tripod", tripod_mesh());
  BopImage image = pile(catalogue, 5);
  ASSERT_GT(best_score(plan_of(image, catalogue)), 0.5) << "the planner knows the part";
  fill(image.frame, 1, std::uniform_real_distribution(500.0, 4500.0));
  expect_nothing(plan_of(image, catalogue));
  fill(image.frame, 2, std::uniform_real_distribution(600.0, 760.0));
  const PlanAnswer answer = plan_of(image, catalogue);
  expect_nothing(answer);
  EXPECT_EQ(answer.outcome, Outcome::kNoneRegistered) << "the bin is not empty";
  EXPECT_THAT(answer.reason, HasSubstr("noise"));
  image.bin.reset();
  expect_nothing(plan_of(image, catalogue));
}

TEST_F(BadFrames, InANoisyPlaneThereIsNothingToBeSureOf) {
  const parts::Catalogue catalogue = catalogue_of("tripod", tripod_mesh());
  BopImage image = pile(catalogue, 5);
  for (const double height_mm : {0.0, 40.0, 80.0}) {
    for (std::uint32_t seed = 1; seed <= 3; ++seed) {
      fill(image.frame, seed, std::normal_distribution(750 - height_mm, 10.0));
      const PlanAnswer answer = plan_of(image, catalogue);
      EXPECT_LT(best_score(answer), parameters_.registration.min_verified_score)
          << height_mm << " mm above the floor, seed " << seed << ", " << answer.objects.size();
    }
  }
}

// Not each answer is wrong to be sure of: with its third arm hidden, a part is its mirror image.
TEST_F(BadFrames, AMirroredFrameScoresLower) {
  constexpr double kConfident = 0.4;
  const auto confident_n = [](const PlanAnswer& answer) {
    return std::ranges::count_if(answer.objects,
                                 [](const Object& object) { return object.score >= kConfident; });
  };
  const parts::Catalogue catalogue = catalogue_of("tripod", tripod_mesh());
  std::ptrdiff_t right_n = 0;
  std::ptrdiff_t mirrored_n = 0;
  for (std::uint64_t seed = 1; seed <= 6; ++seed) {
    BopImage image = pile(catalogue, 5, seed);
    const PlanAnswer right = plan_of(image, catalogue);
    mirror(image);
    const PlanAnswer mirrored = plan_of(image, catalogue);
    EXPECT_LT(best_score(mirrored), best_score(right)) << "seed " << seed;
    right_n += confident_n(right);
    mirrored_n += confident_n(mirrored);
  }
  EXPECT_GE(right_n, 15);
  EXPECT_LT(3 * mirrored_n, right_n);
}

TEST_F(BadFrames, OfAFrameHalfEmptyTheOtherHalfStands) {
  const parts::Catalogue catalogue = catalogue_of("tripod", tripod_mesh());
  const parts::Part& part = catalogue.parts().front();
  BopImage image = pile(catalogue, 12);
  const CameraIntrinsics& camera = image.frame.camera;
  const int middle_px = camera.width_px / 2;
  const Eigen::Isometry3d T_camera_base = image.T_world_camera->inverse();
  // Of the part's barycentre from the middle, in diameters.
  const auto right_of_middle = [&](const Object& object) {
    const Eigen::Vector3d p_m = T_camera_base * object.T_base_part * part.barycentre_m;
    return (project(camera, p_m).x() - middle_px) / camera.fx_px * p_m.z() / part.diameter_m;
  };
  const PlanAnswer whole = plan_of(image, catalogue);
  for (std::size_t i = 0; i < image.frame.depth.size(); ++i) {
    if (static_cast<int>(i) % camera.width_px < middle_px) image.frame.depth[i] = 0;
  }
  EXPECT_THAT(whole.warnings, IsEmpty());
  const PlanAnswer half = plan_of(image, catalogue);
  EXPECT_THAT(half.warnings, ElementsAre(AllOf(HasSubstr("only "),
                                               HasSubstr("% of the pixels that"
                                                         " look into the bin have a reading"))));
  for (const Object& object : half.objects) EXPECT_GT(right_of_middle(object), -0.25);
  int compared_n = 0;
  for (const Object& object : whole.objects) {
    if (right_of_middle(object) < 0.4) continue;
    ++compared_n;
    EXPECT_TRUE(std::ranges::any_of(
        half.objects,
        [&](const Object& other) {
          return eval::mssd_m(part, other.T_base_part, object.T_base_part) < 0.1 * part.diameter_m;
        }))
        << "an object " << right_of_middle(object) << " diameters from the middle is lost";
  }
  EXPECT_GE(compared_n, 2);
}

TEST_F(BadFrames, APartBiggerThanTheBinIsRefused) {
  const parts::Catalogue tripods = catalogue_of("tripod", tripod_mesh());
  const BopImage image = pile(tripods, 5);
  const auto refused = try_plan(image, catalogue_of("giant", tripod_mesh(0.08)));
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, Code::kInvalidArgument);
  EXPECT_THAT(refused.error().message, HasSubstr("bin.inner_size_m: 0.3 × 0.24 × 0.12 m has no "
                                                 "room for part 'giant', which is 0.58"));
  // Just short enough for the diagonal.
  expect_nothing(plan_of(image, catalogue_of("large", tripod_mesh(0.05))));
}

TEST_F(BadFrames, APartOfAFewPixelsIsSaidToBeTooSmall) {
  const parts::Catalogue pins = catalogue_of("pin", cubes_mesh({{0, 0, 0}}, 0.008));
  const PlanAnswer answer = plan_of(pile(pins, 8), pins);
  expect_nothing(answer);
  ASSERT_EQ(answer.warnings.size(), 1U);
  EXPECT_THAT(answer.warnings[0], AllOf(HasSubstr("part 'pin' shows 27 pixels at most from 0.75 m"),
                                        HasSubstr("bring the camera to 0.6")));
  const parts::Catalogue tripods = catalogue_of("tripod", tripod_mesh());
  EXPECT_THAT(plan_of(pile(tripods, 2), tripods).warnings, IsEmpty());
}

TEST_F(BadFrames, AMeshInsideOutGivesTheSameAnswers) {
  const parts::Mesh mesh = tripod_mesh();
  const parts::Catalogue catalogue = catalogue_of("tripod", mesh);
  const parts::Part& part = catalogue.parts().front();
  const BopImage image = pile(catalogue, 5);
  const PlanAnswer right = plan_of(image, catalogue);
  ASSERT_GE(right.objects.size(), 3U);
  for (const std::size_t step : {1U, 3U}) {
    parts::Mesh turned = mesh;
    for (std::size_t i = 0; i < turned.triangles.size(); i += step) {
      std::swap(turned.triangles[i][1], turned.triangles[i][2]);
    }
    const PlanAnswer answer = plan_of(image, catalogue_of("tripod", turned));
    ASSERT_EQ(answer.objects.size(), right.objects.size());
    for (std::size_t i = 0; i < right.objects.size(); ++i) {
      EXPECT_LT(eval::mssd_m(part, answer.objects[i].T_base_part, right.objects[i].T_base_part),
                0.001);
      EXPECT_NEAR(answer.objects[i].score, right.objects[i].score, 0.01);
    }
  }
}

}  // namespace
}  // namespace graspd::perception
