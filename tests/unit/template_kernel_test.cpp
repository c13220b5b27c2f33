#include "graspd/perception/template_kernel.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <tuple>

#include "random_points.hpp"

namespace graspd::perception {
namespace {

using parts::PoseTemplates;
using Match = std::tuple<float, std::uint32_t, std::uint32_t>;

std::vector<Match> match_by_hand(const PoseTemplates& templates, const SampledReading& reading,
                                 const TemplateLimits& limits, std::size_t& compared_n) {
  std::vector<Match> matches;
  compared_n = 0;
  for (std::uint32_t turn = 0; turn < PoseTemplates::kTurns; ++turn) {
    for (std::uint32_t t = 0; t < templates.size(); ++t) {
      const float cosine = reading.nx[turn] * templates.nx[t] + reading.ny[turn] * templates.ny[t] +
                           reading.nz[turn] * templates.nz[t];
      if (cosine < limits.min_cosine) continue;
      ++compared_n;
      int support_n = 0, refute_n = 0, all_n = 0;
      for (std::uint32_t i = 0; i < PoseTemplates::kSamples; ++i) {
        const std::uint32_t there =
            (i + PoseTemplates::kRings * turn) % std::uint32_t{PoseTemplates::kSamples};
        if ((templates.inside[t] >> i & 1U) == 0 || (reading.has_reading >> there & 1U) == 0)
          continue;
        const int error = std::clamp(
            int{reading.depths[there]} - int{templates.depths[t * PoseTemplates::kSamples + i]},
            -128, 127);
        ++all_n;
        support_n += std::abs(error) <= limits.tolerance;
        refute_n += error > limits.tolerance;
      }
      const float score = float(support_n - refute_n) / float(all_n + 6);
      if (support_n >= limits.min_support_n && score >= limits.min_score) {
        matches.emplace_back(score, t, turn);
      }
    }
  }
  return matches;
}

TEST(TemplateKernel, MatchesAsOneSampleAfterTheOther) {
  std::mt19937_64 random(5);
  std::uniform_int_distribution<int> depth(-127, 127);
  const auto random_depth = [&] {
    return static_cast<std::int8_t>(depth(random) / (random() % 2 == 0 ? 1 : 8));
  };
  const auto mostly_set = [&] {
    const std::uint64_t bits = random();
    return bits | random();
  };
  TemplateMatches matches;
  std::size_t found_n = 0;
  for (const std::size_t templates_n : {1, 15, 16, 17, 200}) {
    std::mt19937 normals{static_cast<std::uint32_t>(templates_n)};
    PoseTemplates templates;
    for (std::size_t t = 0; t < templates_n; ++t) {
      for (int i = 0; i < PoseTemplates::kSamples; ++i) templates.depths.push_back(random_depth());
      templates.inside.push_back(mostly_set());
      templates.views.push_back(0);
      const Eigen::Vector3f n = testing::random_point(normals, 1).normalized();
      templates.nx.push_back(n.x());
      templates.ny.push_back(n.y());
      templates.nz.push_back(n.z());
    }
    for (auto* array : {&templates.nx, &templates.ny, &templates.nz}) {
      array->resize(templates_n + PoseTemplates::kReadAhead);
    }
    for (const float min_cosine : {-2.0F, 0.5F}) {
      SampledReading reading{};
      reading.has_reading = mostly_set();
      for (int i = 0; i < PoseTemplates::kSamples; ++i) {
        reading.depths[i] = reading.depths[i + PoseTemplates::kSamples] = random_depth();
      }
      for (int k = 0; k < PoseTemplates::kTurns; ++k) {
        const Eigen::Vector3f n = testing::random_point(normals, 1).normalized();
        reading.nx[k] = n.x(), reading.ny[k] = n.y(), reading.nz[k] = n.z();
      }
      const TemplateLimits limits{min_cosine, 30, 8, 0.1F};
      match_templates(templates, reading, limits, matches);
      std::vector<Match> found;
      for (std::size_t i = 0; i < matches.kept_n; ++i) {
        found.emplace_back(matches.kept[i].score, matches.kept[i].index, matches.kept[i].turn);
      }
      std::size_t compared_n = 0;
      EXPECT_EQ(found, match_by_hand(templates, reading, limits, compared_n));
      EXPECT_EQ(matches.compared_n, compared_n);
      found_n += found.size();
    }
  }
  EXPECT_GT(found_n, 100U);
}

}  // namespace
}  // namespace graspd::perception
