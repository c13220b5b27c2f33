#include "graspd/perception/template_kernel.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <numbers>
#include <random>
#include <tuple>

#include "random_points.hpp"

namespace graspd::perception {
namespace {

using parts::PoseTemplates;
using Match = std::tuple<float, std::uint32_t, std::uint32_t>;

constexpr float kTurn_rad = 2 * std::numbers::pi_v<float> / PoseTemplates::kTurns;

/// Of the template's anchor and the reading in a turn.
float cosine_between(const Eigen::Vector3f& anchor, const Eigen::Vector3f& reading,
                     std::uint32_t turn) {
  const Eigen::AngleAxisf back(-kTurn_rad * static_cast<float>(turn), Eigen::Vector3f::UnitZ());
  return anchor.dot(back * reading);
}

/// All that pass, the best first.
std::vector<Match> match_by_hand(const PoseTemplates& templates,
                                 const std::vector<Eigen::Vector3f>& normals,
                                 const SampledReading& reading, const Eigen::Vector3f& normal,
                                 const TemplateLimits& limits, std::size_t& compared_n) {
  std::vector<Match> matches;
  compared_n = 0;
  for (std::uint32_t turn = 0; turn < PoseTemplates::kTurns; ++turn) {
    for (std::uint32_t t = 0; t < templates.size(); ++t) {
      if (cosine_between(normals[t], normal, turn) < limits.min_cosine) continue;
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
        matches.emplace_back(-score, t, turn);
      }
    }
  }
  std::sort(matches.begin(), matches.end());
  if (matches.size() > limits.most_n) matches.resize(limits.most_n);
  return matches;
}

TEST(TemplateKernel, FindsTheBestAsOneSampleAfterTheOtherWould) {
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
    std::mt19937 directions{static_cast<std::uint32_t>(templates_n)};
    std::vector<Eigen::Vector3f> normals;
    PoseTemplates templates;
    for (std::size_t t = 0; t < templates_n; ++t) {
      for (int i = 0; i < PoseTemplates::kSamples; ++i) templates.depths.push_back(random_depth());
      templates.inside.push_back(mostly_set());
      templates.views.push_back(0);
      normals.push_back(testing::random_point(directions, 1).normalized());
      const auto [sine, cosine, turns] = PoseTemplates::polar(normals.back());
      templates.normal_sine.push_back(sine);
      templates.normal_cosine.push_back(cosine);
      templates.normal_turns.push_back(turns);
    }
    for (auto* array :
         {&templates.normal_sine, &templates.normal_cosine, &templates.normal_turns}) {
      array->resize(templates_n + PoseTemplates::kReadAhead);
    }
    for (const float min_cosine : {-2.0F, 0.5F}) {
      SampledReading reading{};
      reading.has_reading = mostly_set();
      for (int i = 0; i < PoseTemplates::kSamples; ++i) {
        reading.depths[i] = reading.depths[i + PoseTemplates::kSamples] = random_depth();
      }
      const Eigen::Vector3f normal = testing::random_point(directions, 1).normalized();
      const auto [sine, cosine, turns] = PoseTemplates::polar(normal);
      reading.normal_sine = sine;
      reading.normal_cosine = cosine;
      reading.normal_turns = turns;
      const TemplateLimits limits{min_cosine, 30, 8, 0.1F, 24};
      match_templates(templates, reading, limits, matches);
      std::vector<Match> found;
      for (std::size_t i = 0; i < matches.kept_n; ++i) {
        found.emplace_back(-matches.kept[i].score, matches.kept[i].index(), matches.kept[i].turn());
      }
      std::size_t compared_n = 0;
      EXPECT_EQ(found, match_by_hand(templates, normals, reading, normal, limits, compared_n));
      EXPECT_EQ(matches.compared_n, compared_n);
      found_n += found.size();
    }
  }
  EXPECT_GT(found_n, 100U);
}

}  // namespace
}  // namespace graspd::perception
