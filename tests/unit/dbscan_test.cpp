#include "graspd/perception/dbscan.hpp"

#include <gtest/gtest.h>

#include <map>
#include <set>

#include "random_points.hpp"

namespace graspd::perception {
namespace {

constexpr float kEps_m = 0.003f;

/// DBSCAN straight from the definitions: quadratic, and nothing shared with the real one.
struct Twin {
  std::vector<std::set<std::uint32_t>> reach;
  std::vector<bool> is_core;
  std::vector<int> label;  // of core points; -1 for others

  Twin(const Cloud& cloud, float eps_m, int min_points_n) {
    const std::size_t count = cloud.size();
    reach.resize(count);
    for (std::uint32_t i = 0; i < count; ++i) {
      for (std::uint32_t j = 0; j < count; ++j) {
        const float distance2 = (cloud.points_m[i] - cloud.points_m[j]).squaredNorm();
        if (distance2 <= eps_m * eps_m) reach[i].insert(j);
      }
      is_core.push_back(static_cast<int>(reach[i].size()) >= min_points_n);
    }
    label.assign(count, -1);
    for (std::uint32_t i = 0; i < count; ++i) label[i] = is_core[i] ? static_cast<int>(i) : -1;
    for (bool changed = true; changed;) {  // the lowest label floods each density-connected set
      changed = false;
      for (std::uint32_t i = 0; i < count; ++i) {
        if (!is_core[i]) continue;
        for (const std::uint32_t j : reach[i]) {
          if (!is_core[j] || label[j] >= label[i]) continue;
          label[i] = label[j];
          changed = true;
        }
      }
    }
  }
};

class DbscanTwin : public ::testing::TestWithParam<int> {};

TEST_P(DbscanTwin, IsExactlyDbscan) {
  std::mt19937 random(3);
  for (int round = 0; round < 10; ++round) {
    const Cloud cloud = testing::clumpy_cloud(random, 300);
    const Octree octree(cloud.points_m, 8);
    const DbscanResult result = dbscan(cloud, octree.neighbourhoods(kEps_m), GetParam());
    const Twin twin(cloud, kEps_m, GetParam());

    EXPECT_EQ(result.is_core, twin.is_core);
    std::map<int, int> ours_of_twin;
    std::set<int> used;
    for (std::uint32_t i = 0; i < cloud.size(); ++i) {
      if (!twin.is_core[i]) continue;
      const auto [entry, is_new] = ours_of_twin.emplace(twin.label[i], result.labels[i]);
      EXPECT_EQ(entry->second, result.labels[i]);
      EXPECT_TRUE(!is_new || used.insert(result.labels[i]).second);
    }
    EXPECT_EQ(static_cast<int>(ours_of_twin.size()), result.clusters_n);
    for (std::uint32_t i = 0; i < cloud.size(); ++i) {
      if (twin.is_core[i]) continue;
      // A border point belongs to a cluster in whose reach it is; noise is in the reach of none.
      std::set<int> allowed;
      for (const std::uint32_t j : twin.reach[i]) {
        if (twin.is_core[j]) allowed.insert(ours_of_twin.at(twin.label[j]));
      }
      if (allowed.empty()) allowed.insert(kNoise);
      EXPECT_TRUE(allowed.contains(result.labels[i]));
    }
  }
}

INSTANTIATE_TEST_SUITE_P(MinPoints, DbscanTwin, ::testing::Values(1, 4, 10, 40));

/// Two flat patches of core points, `angle_rad` between their normals, with a thin bridge of border
/// points between them.
struct Patches {
  Cloud cloud;
  Neighbourhoods neighbourhoods;
  DbscanResult result;

  Patches(double angle_rad, float curvature_of_second) {
    const float step_m = 0.001f;
    for (int x = 0; x < 5; ++x) {
      for (int y = 0; y < 5; ++y) add(at(x, y) * step_m, 0, 0);
    }
    // In reach of both patches' edges, yet with too few neighbours to be core.
    add(Eigen::Vector3f(5.4f, 2, 0) * step_m, 0, 0);
    for (int x = 0; x < 5; ++x) {
      for (int y = 0; y < 5; ++y) {
        add((at(x, y) + Eigen::Vector3f(6.8f, 0, 0)) * step_m, angle_rad, curvature_of_second);
      }
    }
    neighbourhoods = Octree(cloud.points_m, 6).neighbourhoods(1.5f * step_m);
    result = dbscan(cloud, neighbourhoods, 6);
  }
  static Eigen::Vector3f at(int x, int y) {
    return {static_cast<float>(x), static_cast<float>(y), 0};
  }
  void add(const Eigen::Vector3f& p, double angle_rad, float curvature) {
    cloud.points_m.push_back(p);
    cloud.normals.emplace_back(static_cast<float>(std::sin(angle_rad)), 0.0f,
                               static_cast<float>(-std::cos(angle_rad)));
    cloud.curvatures.push_back(curvature);
  }
};

TEST(MergeAtBorders, LeavesWhatNoBorderPointJoins) {
  Patches patches(0, 0);
  ASSERT_EQ(patches.result.clusters_n, 2);
  const auto before = patches.result.labels;
  // The border point's best partner is in its own cluster: nothing to merge.
  merge_at_borders(patches.cloud, patches.neighbourhoods, 0.2, 0.05, patches.result);
  EXPECT_EQ(patches.result.labels, before);
}

/// A border point whose nearest core point is in one cluster, and whose neighbourhood has most in
/// common with a core point of the other.
struct Bridge {
  Cloud cloud;
  Neighbourhoods neighbourhoods;
  DbscanResult result;
  explicit Bridge(double angle_rad, float curvature_of_second = 0) {
    // Ids: 0–3 first cluster (0 core), 4 the border point, 5–8 second cluster (5 core).
    const auto add = [&](float x, double angle, float curvature) {
      cloud.points_m.emplace_back(x, 0.0f, 0.0f);
      cloud.normals.emplace_back(static_cast<float>(std::sin(angle)), 0.0f,
                                 static_cast<float>(-std::cos(angle)));
      cloud.curvatures.push_back(curvature);
    };
    for (int i = 0; i < 4; ++i) add(0, 0, 0);
    add(1, 0, 0);
    for (int i = 0; i < 4; ++i) add(2.5f, angle_rad, curvature_of_second);
    // Written by hand: eps-neighbourhoods that no metric has to explain.
    const std::vector<Indices> of = {{0, 1, 2, 3, 4}, {0, 1},          {0, 2},
                                     {0, 3},          {0, 4, 5, 6, 7}, {4, 5, 6, 7, 8, 4},
                                     {4, 5, 6},       {4, 5, 7},       {5, 8}};
    neighbourhoods.offsets.push_back(0);
    for (Indices one : of) {
      std::sort(one.begin(), one.end());
      one.erase(std::unique(one.begin(), one.end()), one.end());
      neighbourhoods.indices.insert(neighbourhoods.indices.end(), one.begin(), one.end());
      neighbourhoods.offsets.push_back(static_cast<std::uint32_t>(neighbourhoods.indices.size()));
    }
    result.labels = {0, 0, 0, 0, 0, 1, 1, 1, 1};
    result.is_core = {true, false, false, false, false, true, false, false, false};
    result.clusters_n = 2;
  }
};

TEST(MergeAtBorders, JoinsAcrossASmoothSurface) {
  Bridge bridge(0.1);
  merge_at_borders(bridge.cloud, bridge.neighbourhoods, 0.2, 0.05, bridge.result);
  EXPECT_EQ(bridge.result.clusters_n, 1);
  EXPECT_EQ(bridge.result.labels, std::vector<std::int32_t>(9, 0));
}

TEST(MergeAtBorders, KeepsApartWhereTheNormalsDiffer) {
  Bridge bridge(0.3);
  merge_at_borders(bridge.cloud, bridge.neighbourhoods, 0.2, 0.05, bridge.result);
  EXPECT_EQ(bridge.result.clusters_n, 2);
}

TEST(MergeAtBorders, KeepsApartWhereTheCurvaturesDiffer) {
  Bridge bridge(0.1, 0.06f);
  merge_at_borders(bridge.cloud, bridge.neighbourhoods, 0.2, 0.05, bridge.result);
  EXPECT_EQ(bridge.result.clusters_n, 2);
}

TEST(MergeAtBorders, NumbersClustersWithoutGaps) {
  Bridge bridge(0.1);
  bridge.cloud.points_m.emplace_back(100.0f, 0.0f, 0.0f);
  bridge.cloud.normals.emplace_back(0.0f, 0.0f, -1.0f);
  bridge.cloud.curvatures.push_back(0);
  bridge.neighbourhoods.indices.push_back(9);
  bridge.neighbourhoods.offsets.push_back(bridge.neighbourhoods.offsets.back() + 1);
  bridge.result.labels.push_back(2);
  bridge.result.is_core.push_back(true);
  bridge.result.clusters_n = 3;
  merge_at_borders(bridge.cloud, bridge.neighbourhoods, 0.2, 0.05, bridge.result);
  EXPECT_EQ(bridge.result.clusters_n, 2);
  EXPECT_EQ(bridge.result.labels.back(), 1);
  EXPECT_EQ(clusters_of(bridge.result).back(), Indices{9});
}

}  // namespace
}  // namespace graspd::perception
