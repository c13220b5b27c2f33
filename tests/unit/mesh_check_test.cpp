#include "graspd/parts/mesh_check.hpp"

#include <gmock/gmock.h>

#include "part_test_support.hpp"

namespace graspd::parts {
namespace {

using ::testing::AllOf;
using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;

Mesh good_mesh() { return box_mesh({0, 0, 0}, {0.06F, 0.04F, 0.02F}, 4); }

/// What is not as it should be.
std::vector<MeshFinding> faults(const Mesh& mesh, const SensorResolution& sensor = {}) {
  std::vector<MeshFinding> found;
  for (const MeshFinding& finding : check_mesh(mesh, sensor)) {
    EXPECT_FALSE(finding.sentence.empty());
    if (finding.severity != Severity::kOk) found.push_back(finding);
  }
  return found;
}

/// Expects one fault, and returns its sentence.
std::string only_fault(const Mesh& mesh, const std::string& topic, Severity severity,
                       const SensorResolution& sensor = {}) {
  const auto found = faults(mesh, sensor);
  if (found.size() != 1) {
    for (const auto& finding : found) ADD_FAILURE() << finding.topic << ": " << finding.sentence;
    if (found.empty()) ADD_FAILURE() << "nothing was found";
    return {};
  }
  EXPECT_EQ(found[0].topic, topic) << found[0].sentence;
  EXPECT_EQ(found[0].severity, severity) << found[0].sentence;
  return found[0].sentence;
}

TEST(CheckMesh, FindsNothingWrongWithAGoodMeshAndSaysSoOfEachTopic) {
  EXPECT_THAT(faults(good_mesh()), IsEmpty());
  std::vector<std::string> topics;
  for (const auto& finding : check_mesh(good_mesh(), {})) topics.push_back(finding.topic);
  EXPECT_THAT(topics, ElementsAre("units", "normals", "holes", "edges", "triangles", "pieces",
                                  "symmetries", "size", "walls"));
}

TEST(CheckMesh, NoTriangles) {
  EXPECT_THAT(only_fault(Mesh{}, "triangles", Severity::kError), HasSubstr("0 triangles"));
}

TEST(CheckMesh, MillimetresDeclaredAsMetres) {
  const auto sentence = only_fault(scaled(good_mesh(), 1000), "units", Severity::kError);
  EXPECT_THAT(sentence, HasSubstr("7.483e+04 mm across"));
  EXPECT_THAT(sentence, HasSubstr("mm instead of m (then it is 74.83 mm across)"));
}

TEST(CheckMesh, MetresDeclaredAsMillimetres) {
  EXPECT_THAT(only_fault(scaled(good_mesh(), 1e-3F), "units", Severity::kError),
              HasSubstr("m instead of mm (then it is 74.83 mm across)"));
}

TEST(CheckMesh, InchesDeclaredAsMillimetres) {
  EXPECT_THAT(only_fault(scaled(good_mesh(), 1 / 25.4F), "units", Severity::kWarning),
              HasSubstr("in instead of mm (then it is 74.83 mm across)"));
}

TEST(CheckMesh, TooSmallForABinSaysWhatTheCameraMakesOfIt) {
  for (const MeshFinding& finding :
       check_mesh(scaled(good_mesh(), 1 / 25.4F), {}, LengthUnit::kMillimetre)) {
    EXPECT_NE(finding.topic, "size");
    if (finding.topic != "units") continue;
    EXPECT_THAT(finding.sentence,
                AllOf(HasSubstr("its unit is probably in (then it is 74.83 mm across). If"),
                      HasSubstr("pixels wide at 0.75 m; telling its pose takes 10.")));
  }
}

TEST(CheckMesh, WhatIsNoSolidHasNoThickness) {
  Mesh flat = good_mesh();
  for (auto& vertex : flat.vertices_m) vertex.z() = 0;
  std::vector<std::string> topics;
  for (const MeshFinding& finding : check_mesh(flat, {})) topics.push_back(finding.topic);
  EXPECT_THAT(topics, Contains("solid"));
  EXPECT_THAT(topics, Not(Contains("size")));
}

TEST(CheckMesh, InsideOut) {
  Mesh mesh = good_mesh();
  for (auto& triangle : mesh.triangles) std::swap(triangle[0], triangle[1]);
  EXPECT_THAT(only_fault(mesh, "normals", Severity::kWarning),
              HasSubstr("face into the part (its volume is -48 cm³)"));
}

TEST(CheckMesh, OneTriangleWoundTheOtherWay) {
  Mesh mesh = good_mesh();
  std::swap(mesh.triangles[20][0], mesh.triangles[20][1]);
  const auto sentence = only_fault(mesh, "normals", Severity::kWarning);
  EXPECT_THAT(sentence, HasSubstr("1 of 192 triangles is wound against"));
  EXPECT_THAT(sentence, HasSubstr("(0, 26.67, 11.67) mm"));
}

TEST(CheckMesh, MostTrianglesWoundTheOtherWayStillCountsTheFew) {
  Mesh mesh = good_mesh();
  for (std::size_t i = 2; i < mesh.triangles.size(); ++i) {
    std::swap(mesh.triangles[i][0], mesh.triangles[i][1]);
  }
  EXPECT_THAT(only_fault(mesh, "normals", Severity::kWarning), HasSubstr("2 of 192 triangles are"));
}

TEST(CheckMesh, Hole) {
  Mesh mesh = good_mesh();
  mesh.triangles.erase(mesh.triangles.begin() + 20);
  EXPECT_THAT(only_fault(mesh, "holes", Severity::kWarning),
              HasSubstr("1 hole (3 open edges), the widest 11.18 mm across at (0, 25, 12.5) mm"));
}

TEST(CheckMesh, TwoHoles) {
  Mesh mesh = good_mesh();
  mesh.triangles.erase(mesh.triangles.begin() + 150, mesh.triangles.begin() + 152);
  mesh.triangles.erase(mesh.triangles.begin() + 20);
  EXPECT_THAT(only_fault(mesh, "holes", Severity::kWarning), HasSubstr("2 holes (7 open edges)"));
}

TEST(CheckMesh, TwoBoxesThatShareAnEdge) {
  Mesh mesh = box_mesh({0, 0, 0}, {0.03F, 0.03F, 0.03F});
  const Mesh other = box_mesh({0.03F, 0.03F, 0}, {0.03F, 0.03F, 0.03F});
  std::vector<int> index_of;
  for (const auto& vertex : other.vertices_m) {
    const auto same = std::find(mesh.vertices_m.begin(), mesh.vertices_m.end(), vertex);
    index_of.push_back(static_cast<int>(same - mesh.vertices_m.begin()));
    if (same == mesh.vertices_m.end()) mesh.vertices_m.push_back(vertex);
  }
  for (const auto& t : other.triangles) {
    mesh.triangles.push_back({index_of[static_cast<std::size_t>(t[0])],
                              index_of[static_cast<std::size_t>(t[1])],
                              index_of[static_cast<std::size_t>(t[2])]});
  }
  EXPECT_THAT(only_fault(mesh, "edges", Severity::kWarning),
              HasSubstr("At 1 edge more than two triangles meet, the first at (30, 30, 15) mm"));
}

TEST(CheckMesh, TriangleThatIsThereTwice) {
  Mesh mesh = good_mesh();
  const auto t = mesh.triangles[20];
  mesh.triangles.push_back({t[1], t[2], t[0]});
  EXPECT_THAT(only_fault(mesh, "triangles", Severity::kWarning),
              HasSubstr("1 of 193 triangles is there twice"));
}

TEST(CheckMesh, TriangleWithARepeatedVertex) {
  Mesh mesh = good_mesh();
  mesh.triangles.push_back({3, 4, 4});
  EXPECT_THAT(only_fault(mesh, "triangles", Severity::kWarning),
              HasSubstr("1 of 193 triangles has no area"));
}

TEST(CheckMesh, SliverThatStillJoinsItsNeighbours) {
  // One triangle of a side is cut at the middle of an edge, where its neighbour is not: the sliver
  // between them has no area, but closes the surface.
  Mesh mesh = box_mesh({0, 0, 0}, {0.06F, 0.04F, 0.02F});
  const auto [a, b, c] = mesh.triangles[0];
  const int middle = static_cast<int>(mesh.vertices_m.size());
  mesh.vertices_m.push_back(0.5F * (mesh.vertices_m[static_cast<std::size_t>(a)] +
                                    mesh.vertices_m[static_cast<std::size_t>(b)]));
  mesh.triangles[0] = {a, middle, c};
  mesh.triangles.push_back({middle, b, c});
  mesh.triangles.push_back({a, b, middle});
  EXPECT_THAT(only_fault(mesh, "triangles", Severity::kWarning), HasSubstr("no area"));
}

TEST(CheckMesh, SeparatePieces) {
  const Mesh mesh = joined(good_mesh(), box_mesh({0.1F, 0, 0}, {0.02F, 0.02F, 0.02F}));
  EXPECT_THAT(only_fault(mesh, "pieces", Severity::kWarning),
              HasSubstr("2 separate pieces (192 triangles in the largest, 12 in the smallest)"));
}

TEST(CheckMesh, TooManyTriangles) {
  // An uneven sheet, since a closed box of that many would take long to make.
  Mesh mesh;
  const int n = 300;
  for (int i = 0; i <= n; ++i) {
    for (int j = 0; j <= n; ++j) {
      mesh.vertices_m.emplace_back(0.0002F * static_cast<float>(i), 0.0002F * static_cast<float>(j),
                                   0.00001F * static_cast<float>((i * i + j * j) % 997));
    }
  }
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j < n; ++j) {
      const int a = i * (n + 1) + j;
      mesh.triangles.push_back({a, a + n + 1, a + n + 2});
      mesh.triangles.push_back({a, a + n + 2, a + 1});
    }
  }
  const auto found = faults(mesh);
  ASSERT_EQ(found.size(), 3U);  // an open sheet is no solid, and has a hole as well
  EXPECT_EQ(found[0].topic, "solid");
  EXPECT_EQ(found[0].severity, Severity::kError);
  EXPECT_EQ(found[2].topic, "triangles");
  EXPECT_THAT(found[2].sentence, HasSubstr("180000 triangles"));
}

TEST(CheckMesh, TooSmallForTheSensorSaysFromWhereItIsNot) {
  const Mesh rod = box_mesh({0, 0, 0}, {0.06F, 0.015F, 0.015F});
  EXPECT_THAT(only_fault(rod, "size", Severity::kWarning),
              HasSubstr("7.3 pixels wide (15 mm); telling its pose takes 10: bring the camera to "
                        "0.55 m."));
  SensorResolution nearer;
  nearer.distance_m = 0.54;
  EXPECT_THAT(faults(rod, nearer), IsEmpty());

  const Mesh pin = box_mesh({0, 0, 0}, {0.06F, 0.008F, 0.008F});
  EXPECT_THAT(only_fault(pin, "size", Severity::kWarning),
              HasSubstr("0.29 m, which is nearer than a Kinect v2 sees"));
}

TEST(CheckMesh, TooFlatForTheSensor) {
  const Mesh plate = box_mesh({0, 0, 0}, {0.06F, 0.04F, 0.004F});
  EXPECT_THAT(only_fault(plate, "size", Severity::kWarning),
              HasSubstr("4 mm thick, below 4 times the depth noise of 1.4 mm"));
  SensorResolution better;
  better.depth_noise_m = 0.0009;
  EXPECT_THAT(faults(plate, better), IsEmpty());
}

TEST(CheckMesh, WallsThinnerThanAPixel) {
  // A hollow box of 1.5 mm sheet, and one of 3 mm.
  const auto hollow_box = [](float wall_m) {
    const Mesh outside = box_mesh({0, 0, 0}, {0.06F, 0.05F, 0.04F});
    Mesh inside = box_mesh({wall_m, wall_m, wall_m},
                           {0.06F - 2 * wall_m, 0.05F - 2 * wall_m, 0.04F - 2 * wall_m});
    for (auto& triangle : inside.triangles) std::swap(triangle[0], triangle[1]);
    return joined(outside, inside);
  };
  const auto thin = faults(hollow_box(0.0015F));
  ASSERT_EQ(thin.size(), 2U);  // the inside is a piece of its own
  EXPECT_EQ(thin[1].topic, "walls");
  EXPECT_THAT(thin[1].sentence, HasSubstr("thinner than a pixel, which is 2.1 mm wide at 0.75 m"));
  EXPECT_EQ(faults(hollow_box(0.003F)).size(), 1U);
  SensorResolution nearer;
  nearer.distance_m = 0.5;
  EXPECT_EQ(faults(hollow_box(0.0015F), nearer).size(), 1U);
}

}  // namespace
}  // namespace graspd::parts
