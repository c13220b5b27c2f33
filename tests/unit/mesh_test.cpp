#include "graspd/parts/mesh.hpp"

#include <gmock/gmock.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cstring>
#include <limits>
#include <numbers>
#include <random>

#include "part_test_support.hpp"

namespace graspd::parts {
namespace {

using ::testing::HasSubstr;

Mesh cloud(std::size_t n, const std::function<Eigen::Vector3f(std::mt19937&)>& draw) {
  std::mt19937 random(7);
  Mesh mesh;
  for (std::size_t i = 0; i < n; ++i) mesh.vertices_m.push_back(draw(random));
  return mesh;
}

Eigen::Vector3f draw_in_box(std::mt19937& random) {
  std::uniform_real_distribution<float> uniform(-0.05F, 0.05F);
  return {uniform(random), 0.5F * uniform(random), 0.2F * uniform(random)};
}

Eigen::Vector3f draw_on_sphere(std::mt19937& random) {
  std::normal_distribution<float> normal;
  return 0.05F * Eigen::Vector3f(normal(random), normal(random), normal(random)).normalized();
}

Eigen::Vector3f draw_on_cylinder(std::mt19937& random) {
  std::uniform_real_distribution<float> uniform(-1.0F, 1.0F);
  const float angle_rad = std::numbers::pi_v<float> * uniform(random);
  // Half of the points on the rims, where the farthest pairs are.
  const float height_m = std::clamp(0.08F * uniform(random), -0.04F, 0.04F);
  return {0.03F * std::cos(angle_rad), 0.03F * std::sin(angle_rad), height_m};
}

double brute_force_diameter_m(const Mesh& mesh) {
  double best = 0;
  for (const auto& a : mesh.vertices_m) {
    for (const auto& b : mesh.vertices_m) {
      best = std::max(best, (a.cast<double>() - b.cast<double>()).norm());
    }
  }
  return best;
}

// --- loading ----------------------------------------------------------------------------------

TEST(LoadMesh, MergesVerticesAndScalesByUnit) {
  const TestFolder folder;
  const Mesh box = box_mesh({0, 0, 0}, {0.0508F, 0.0254F, 0.0127F});
  for (const auto& [unit, units_per_m] :
       {std::pair{LengthUnit::kMillimetre, 1e3}, std::pair{LengthUnit::kMetre, 1.0},
        std::pair{LengthUnit::kInch, 1 / 0.0254}}) {
    const auto file = folder.write(fmt::format("{}.stl", name_of(unit)), to_stl(box, units_per_m));
    const auto loaded = load_mesh(file, unit);
    ASSERT_TRUE(loaded) << loaded.error().message;
    EXPECT_EQ(loaded->vertices_m.size(), 8U);
    EXPECT_EQ(loaded->triangles.size(), 12U);
    EXPECT_NEAR(signed_volume_m3(*loaded), signed_volume_m3(box), 1e-10);
  }
}

TEST(LoadMesh, ReadsBinaryStlEvenWhereItsHeaderSaysSolid) {
  const TestFolder folder;
  const Mesh box = box_mesh({0, 0, 0}, {0.05F, 0.03F, 0.02F});
  std::string stl(84, '\0');
  std::memcpy(stl.data(), "solid by some exporter", 22);
  const auto triangles_n = static_cast<std::uint32_t>(box.triangles.size());
  std::memcpy(stl.data() + 80, &triangles_n, 4);
  for (const auto& triangle : box.triangles) {
    std::array<float, 12> numbers{};
    for (std::size_t k = 0; k < 3; ++k) {
      Eigen::Map<Eigen::Vector3f>(numbers.data() + 3 + 3 * k) =
          1e3F * box.vertices_m[static_cast<std::size_t>(triangle[k])];
    }
    stl.append(reinterpret_cast<const char*>(numbers.data()), sizeof(numbers));
    stl.append(2, '\0');
  }
  const auto whole = load_mesh(folder.write("BOX.STL", stl), LengthUnit::kMillimetre);
  ASSERT_TRUE(whole) << whole.error().message;
  EXPECT_EQ(whole->vertices_m.size(), 8U);
  EXPECT_NEAR(signed_volume_m3(*whole), 3e-5, 1e-9);

  const auto cut = load_mesh(folder.write("cut.stl", stl.substr(0, 300)), LengthUnit::kMillimetre);
  ASSERT_FALSE(cut);
  EXPECT_EQ(cut.error().code, Code::kInvalidArgument);
  EXPECT_THAT(cut.error().message, HasSubstr("cut.stl"));
}

TEST(LoadMesh, ReadsPlyAndObjWithPolygons) {
  const TestFolder folder;
  const auto ply = folder.write("pyramid.ply",
                                "ply\nformat ascii 1.0\nelement vertex 5\nproperty float x\n"
                                "property float y\nproperty float z\nelement face 5\n"
                                "property list uchar int vertex_indices\nend_header\n"
                                "0 0 0\n30 0 0\n30 30 0\n0 30 0\n15 15 30\n"
                                "4 0 3 2 1\n3 0 1 4\n3 1 2 4\n3 2 3 4\n3 3 0 4\n");
  const auto obj = folder.write("pyramid.obj",
                                "mtllib missing.mtl\n"
                                "v 0 0 0\nv 30 0 0\nv 30 30 0\nv 0 30 0\nv 15 15 30\n"
                                "o base\nusemtl a\nf 1 4 3 2\n"
                                "o sides\nusemtl b\nf 1 2 5\nf 2 3 5\nf 3 4 5\nf 4 1 5\n");
  for (const auto& file : {ply, obj}) {
    const auto mesh = load_mesh(file, LengthUnit::kMillimetre);
    ASSERT_TRUE(mesh) << mesh.error().message;
    EXPECT_EQ(mesh->vertices_m.size(), 5U) << file;
    EXPECT_EQ(mesh->triangles.size(), 6U) << file;
    EXPECT_NEAR(signed_volume_m3(*mesh), 9e-6, 1e-10) << file;
  }
}

struct BadFile {
  std::string name;
  std::string content;
  std::string sentence;
};

TEST(LoadMesh, SaysWhatIsWrongWithAFile) {
  const TestFolder folder;
  const std::string ply_head =
      "ply\nformat ascii 1.0\nelement vertex 2\nproperty float x\n"
      "property float y\nproperty float z\n";
  const std::vector<BadFile> files{
      {"empty.stl", "", "can't be read"},
      {"text.stl", "this is no mesh", "can't be read"},
      {"no_triangle.stl", "solid a\nendsolid a\n", ""},
      {"points.ply", ply_head + "end_header\n0 0 0\n1 1 1\n", ""},
      {"lines.obj", "v 0 0 0\nv 10 0 0\nv 0 10 0\nl 1 2\nl 2 3\n", "0 triangles, only 2 points or"},
      {"nan.obj", "v 0 0 0\nv nan 0 0\nv 0 10 0\nf 1 2 3\n", "not a finite number"},
      {"beyond.obj", "v 0 0 0\nv 1 0 0\nv 0 10 0\nf 1 2 9\n", ""},
      {"part.step", "ISO-10303-21;", "reads STL, PLY and OBJ"}};
  for (const BadFile& file : files) {
    const auto mesh = load_mesh(folder.write(file.name, file.content), LengthUnit::kMillimetre);
    ASSERT_FALSE(mesh) << file.name;
    EXPECT_EQ(mesh.error().code, Code::kInvalidArgument);
    EXPECT_THAT(mesh.error().message, HasSubstr(file.name));
    EXPECT_THAT(mesh.error().message, HasSubstr(file.sentence));
  }
  const auto missing = load_mesh(folder.path() / "missing.stl", LengthUnit::kMillimetre);
  ASSERT_FALSE(missing);
  EXPECT_THAT(missing.error().message, HasSubstr("there is no such file"));
  const auto directory = load_mesh(folder.path(), LengthUnit::kMillimetre);
  ASSERT_FALSE(directory);
  EXPECT_THAT(directory.error().message, HasSubstr("is no file"));
}

// --- measures ---------------------------------------------------------------------------------

TEST(MeshMeasures, AreaVolumeAndBarycentreOfABoxFollowItsPose) {
  const Mesh box = box_mesh({0.01F, -0.02F, 0.03F}, {0.06F, 0.04F, 0.02F}, 3);
  EXPECT_NEAR(surface_area_m2(box), 8.8e-3, 1e-8);
  EXPECT_NEAR(signed_volume_m3(box), 4.8e-5, 1e-10);
  EXPECT_TRUE(barycentre_m(box).isApprox(Eigen::Vector3d(0.04, 0, 0.04), 1e-6));

  Eigen::Isometry3d T(Eigen::AngleAxisd(1.1, Eigen::Vector3d(1, 2, 3).normalized()));
  T.translation() = Eigen::Vector3d(1, -2, 0.5);
  EXPECT_NEAR(surface_area_m2(moved(box, T)), 8.8e-3, 1e-7);
  EXPECT_NEAR(signed_volume_m3(moved(box, T)), 4.8e-5, 1e-9);
  EXPECT_LT((barycentre_m(moved(box, T)) - T * barycentre_m(box)).norm(), 1e-6);
}

TEST(MeshMeasures, VolumeIsNegativeInsideOut) {
  Mesh box = box_mesh({0, 0, 0}, {0.06F, 0.04F, 0.02F});
  for (auto& triangle : box.triangles) std::swap(triangle[0], triangle[1]);
  EXPECT_NEAR(signed_volume_m3(box), -4.8e-5, 1e-10);
  EXPECT_TRUE(barycentre_m(box).isApprox(Eigen::Vector3d(0.03, 0.02, 0.01), 1e-6));
}

TEST(MeshMeasures, BarycentreIsOfTheSolidWhenClosedAndOfTheSurfaceWhenOpen) {
  // Two boxes side by side: by volume the large one counts 27 times, by surface 9 times.
  const Mesh small = box_mesh({0, 0, 0}, {0.01F, 0.01F, 0.01F});
  const Mesh large = box_mesh({0.02F, 0, 0}, {0.03F, 0.03F, 0.03F});
  const double small_x = 0.005;
  const double large_x = 0.035;
  Mesh both = joined(small, large);
  EXPECT_NEAR(barycentre_m(both).x(), (small_x + 27 * large_x) / 28, 1e-7);
  both.triangles.pop_back();
  const Mesh& open = both;
  EXPECT_NEAR(barycentre_m(open).x(), (small_x + 9 * large_x) / 10, 0.0003);
}

TEST(MeshMeasures, DiameterIsThatOfTheBruteForceTwin) {
  for (const auto& draw : {&draw_in_box, &draw_on_sphere, &draw_on_cylinder}) {
    const Mesh mesh = cloud(1500, *draw);
    EXPECT_DOUBLE_EQ(diameter_m(mesh), brute_force_diameter_m(mesh));
  }
  EXPECT_EQ(diameter_m(Mesh{}), 0);
  EXPECT_EQ(diameter_m(cloud(1, &draw_in_box)), 0);
  EXPECT_NEAR(diameter_m(box_mesh({0, 0, 0}, {0.03F, 0.04F, 0.12F}, 7)), 0.13, 1e-7);
}

// The test's time-out is the other expectation of these two.
TEST(MeshMeasures, DiameterOf200000Vertices) {
  EXPECT_NEAR(diameter_m(cloud(200'000, &draw_on_cylinder)), 0.1, 1e-5);
}

TEST(MeshMeasures, DiameterOfASphereWhereEveryPointHasItsFarthest) {
  EXPECT_NEAR(diameter_m(cloud(50'000, &draw_on_sphere)), 0.1, 1e-5);
}

// --- sampling ---------------------------------------------------------------------------------

double nearest_m(const std::vector<SurfacePoint>& points, const Eigen::Vector3f& p) {
  float best = std::numeric_limits<float>::max();
  for (const auto& point : points) best = std::min(best, (point.position_m - p).squaredNorm());
  return std::sqrt(best);
}

class SampleSurface : public ::testing::TestWithParam<int> {};

TEST_P(SampleSurface, CoversABoxEvenly) {
  // However the sides are cut into triangles: two each, or thousands far smaller than the spacing.
  const Mesh box = box_mesh({-0.01F, 0, 0.02F}, {0.06F, 0.04F, 0.02F}, GetParam());
  const double spacing_m = 0.002;
  const auto points = sample_surface(box, spacing_m);

  const double area_m2 = 2 * (0.06 * 0.04 + 0.06 * 0.02 + 0.04 * 0.02);
  EXPECT_NEAR(static_cast<double>(points.size()), area_m2 / (spacing_m * spacing_m),
              0.15 * area_m2 / (spacing_m * spacing_m));
  for (std::size_t i = 0; i < points.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      ASSERT_GE((points[i].position_m - points[j].position_m).norm(), 0.79 * spacing_m);
    }
  }
  std::mt19937 random(11);
  std::uniform_real_distribution<float> uniform;
  for (int i = 0; i < 5000; ++i) {
    Eigen::Vector3f p(uniform(random), uniform(random), uniform(random));
    p[i % 3] = i % 2 == 0 ? 0.0F : 1.0F;
    p = Eigen::Vector3f(-0.01F, 0, 0.02F) + p.cwiseProduct(Eigen::Vector3f(0.06F, 0.04F, 0.02F));
    EXPECT_LE(nearest_m(points, p), spacing_m);
  }
}

TEST_P(SampleSurface, PointsLieOnTheSurfaceWithItsNormals) {
  const Eigen::Vector3f size(0.06F, 0.04F, 0.02F);
  for (const auto& point : sample_surface(box_mesh({0, 0, 0}, size, GetParam()), 0.003)) {
    Eigen::Index axis = 0;
    ASSERT_NEAR(point.normal.cwiseAbs().maxCoeff(&axis), 1.0F, 1e-5F);
    EXPECT_NEAR(point.position_m[axis], point.normal[axis] > 0 ? size[axis] : 0.0F, 1e-6F);
  }
}

INSTANTIATE_TEST_SUITE_P(Cuts, SampleSurface, ::testing::Values(1, 5, 16));

TEST(SampleSurfaceOfAnyMesh, IsTheSameForTheSameMesh) {
  const Mesh box = box_mesh({0, 0, 0}, {0.06F, 0.04F, 0.02F}, 2);
  const auto first = sample_surface(box, 0.004);
  const auto second = sample_surface(box, 0.004);
  ASSERT_EQ(first.size(), second.size());
  for (std::size_t i = 0; i < first.size(); ++i) {
    EXPECT_EQ(first[i].position_m, second[i].position_m);
    EXPECT_EQ(first[i].normal, second[i].normal);
  }
}

TEST(SampleSurfaceOfAnyMesh, CoversBothSidesOfASheetThinnerThanTheSpacing) {
  const auto points = sample_surface(box_mesh({0, 0, 0}, {0.05F, 0.05F, 0.0005F}), 0.002);
  const auto up_n = std::count_if(points.begin(), points.end(),
                                  [](const SurfacePoint& p) { return p.normal.z() > 0.5F; });
  const auto down_n = std::count_if(points.begin(), points.end(),
                                    [](const SurfacePoint& p) { return p.normal.z() < -0.5F; });
  EXPECT_NEAR(static_cast<double>(up_n), 625, 90);
  EXPECT_NEAR(static_cast<double>(down_n), 625, 90);
}

TEST(SampleSurfaceOfAnyMesh, RefusesASpacingThatIsNone) {
  const Mesh box = box_mesh({0, 0, 0}, {0.06F, 0.04F, 0.02F});
  EXPECT_THROW(sample_surface(box, 0), std::invalid_argument);
  EXPECT_THROW(sample_surface(box, std::numeric_limits<double>::quiet_NaN()),
               std::invalid_argument);
  EXPECT_TRUE(sample_surface(Mesh{}, 0.002).empty());
}

}  // namespace
}  // namespace graspd::parts
