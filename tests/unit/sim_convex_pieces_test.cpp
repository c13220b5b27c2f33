#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "graspd/simulation/convex_pieces.hpp"
#include "sim_meshes.hpp"

namespace graspd::simulation {
namespace {

using testing::box_mesh;
using testing::pipe_mesh;
using testing::sphere_mesh;

double total_volume_m3(const std::vector<ConvexPiece>& pieces) {
  double sum = 0;
  for (const ConvexPiece& piece : pieces) sum += piece.volume_m3;
  return sum;
}

double reach_m(const std::vector<Eigen::Vector3d>& points, const Eigen::Vector3d& direction) {
  double farthest = std::numeric_limits<double>::lowest();
  for (const auto& p : points) farthest = std::max(farthest, p.dot(direction));
  return farthest;
}

/// Whether a vertical line meets the hull: not if the vertices, seen from the line, leave a gap of
/// half a turn.
bool vertical_line_meets(const ConvexPiece& piece, double x_m, double y_m) {
  std::vector<double> angles;
  for (const auto& p : piece.vertices_m) angles.push_back(std::atan2(p.y() - y_m, p.x() - x_m));
  std::sort(angles.begin(), angles.end());
  double gap = angles.front() + 2 * std::numbers::pi - angles.back();
  for (std::size_t i = 1; i < angles.size(); ++i) gap = std::max(gap, angles[i] - angles[i - 1]);
  return gap < std::numbers::pi;
}

TEST(ConvexPiecesTest, AConvexSolidIsOnePiece) {
  const auto pieces = convex_pieces(box_mesh({0.02, 0.03, 0.05}));
  ASSERT_EQ(pieces.size(), 1u);
  EXPECT_NEAR(pieces[0].volume_m3, 0.02 * 0.03 * 0.05, 1e-7);
  EXPECT_EQ(pieces[0].vertices_m.size(), 8u);
}

TEST(ConvexPiecesTest, APipeKeepsItsHole) {
  const auto mesh = pipe_mesh(0.015, 0.012, 0.06);
  const auto pieces = convex_pieces(mesh);
  for (const ConvexPiece& piece : pieces) {
    for (int i = 0; i < 12; ++i) {
      const double angle = 2 * std::numbers::pi * i / 12;
      EXPECT_FALSE(vertical_line_meets(piece, 0.009 * std::cos(angle), 0.009 * std::sin(angle)));
    }
  }
  EXPECT_NEAR(total_volume_m3(pieces), parts::signed_volume_m3(mesh),
              0.15 * parts::signed_volume_m3(mesh));
}

TEST(ConvexPiecesTest, TogetherTheyReachAsFarAsTheMesh) {
  std::mt19937 random(7);
  std::normal_distribution<double> normal;
  for (const auto& mesh : {pipe_mesh(0.017, 0.014, 0.06), box_mesh({0.01, 0.02, 0.03})}) {
    std::vector<Eigen::Vector3d> vertices, corners;
    for (const auto& p : mesh.vertices_m) vertices.push_back(p.cast<double>());
    for (const ConvexPiece& piece : convex_pieces(mesh)) {
      corners.insert(corners.end(), piece.vertices_m.begin(), piece.vertices_m.end());
    }
    for (int i = 0; i < 200; ++i) {
      const auto direction =
          Eigen::Vector3d(normal(random), normal(random), normal(random)).normalized();
      EXPECT_NEAR(reach_m(corners, direction), reach_m(vertices, direction),
                  0.01 * parts::diameter_m(mesh));
    }
  }
}

TEST(ConvexPiecesTest, TheBudgetIsKeptToWithinOneCut) {
  const auto mesh = pipe_mesh(0.015, 0.012, 0.06);
  std::size_t last_n = 0;
  double last_m3 = std::numeric_limits<double>::max();
  for (const int budget : {1, 4, 12}) {
    const auto pieces = convex_pieces(mesh, {budget, 0.01});
    EXPECT_LE(pieces.size(), std::size_t(budget) + 2);
    EXPECT_GT(pieces.size(), last_n);
    EXPECT_LT(total_volume_m3(pieces), last_m3);
    last_n = pieces.size();
    last_m3 = total_volume_m3(pieces);
  }
}

TEST(ConvexPiecesTest, AFineMeshIsThinnedAndKeepsItsShape) {
  const auto mesh = sphere_mesh(0.02);  // 37,000 triangles
  const auto pieces = convex_pieces(mesh);
  ASSERT_EQ(pieces.size(), 1u);
  EXPECT_LT(pieces[0].vertices_m.size(), 400u);
  EXPECT_NEAR(pieces[0].volume_m3, parts::signed_volume_m3(mesh),
              0.06 * parts::signed_volume_m3(mesh));
}

TEST(ConvexPiecesTest, TheSameMeshGivesTheSamePieces) {
  const auto mesh = pipe_mesh(0.015, 0.012, 0.06);
  const auto a = convex_pieces(mesh), b = convex_pieces(mesh);
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i) EXPECT_EQ(a[i].vertices_m, b[i].vertices_m);
}

TEST(ConvexPiecesTest, AnEmptyMeshHasNoPieces) { EXPECT_TRUE(convex_pieces({}).empty()); }

}  // namespace
}  // namespace graspd::simulation
