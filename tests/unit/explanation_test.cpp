#include "graspd/perception/explanation.hpp"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include "block_grid.hpp"
#include "graspd/perception/hypotheses.hpp"

namespace graspd::perception {
namespace {

using Eigen::Vector3d;

/// Three blocks on a floor, two of them leaning on each other.
class ThreeBlocks : public ::testing::Test {
 protected:
  static constexpr double kFloor_m = 0.75;
  const Vector3d size_m_{0.09, 0.05, 0.03};

  ThreeBlocks() {
    const auto add = [&](const Vector3d& t_m, double angle_rad, const Vector3d& axis) {
      Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
      T.translate(t_m).rotate(Eigen::AngleAxisd(angle_rad, axis.normalized()));
      blocks_.push_back({T, size_m_});
    };
    add({-0.10, 0, 0.72}, 0.5, {1, 0.6, 0.3});
    add({0.00, 0.01, 0.72}, 0.9, {0.2, 0.5, 1});
    add({0.07, 0.01, 0.70}, 0.6, {0.1, 1, 0.4});
    grid_ = testing::grid_of(blocks_, kFloor_m);
  }

  /// Of the nearest block: how far the answer's centre is from its.
  double off_m(const PoseHypothesis& pose) const {
    double nearest_m = 1;
    for (const auto& block : blocks_) {
      nearest_m = std::min(nearest_m,
                           (block.T_camera_block.translation() - pose.t_m.cast<double>()).norm());
    }
    return nearest_m;
  }

  Explanation explain_all(std::vector<PoseHypothesis> poses) {
    Explanation explanation;
    explain(grid_, verifier_, scene_, std::move(poses), parameters_, never_late, explanation);
    return explanation;
  }

  RegistrationParameters parameters_;
  std::vector<testing::Block> blocks_;
  DepthGrid grid_;
  parts::Part block_ = testing::block_part("block", size_m_);
  const parts::Part* const parts_[1] = {&block_};
  PoseVerifier verifier_{grid_, parts_, parameters_};
  Scene scene_;
};

TEST_F(ThreeBlocks, AreFoundWhateverTheNumberOfThreads) {
  std::vector<std::vector<PoseHypothesis>> found;
  for (const int threads_n : {1, 2, 4}) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism,
                                    std::size_t(threads_n));
    found.push_back(find_hypotheses(grid_, verifier_, parts_, parameters_).poses);
  }
  ASSERT_FALSE(found[0].empty());
  for (const auto& other : found) {
    ASSERT_EQ(other.size(), found[0].size());
    for (std::size_t i = 0; i < other.size(); ++i) {
      EXPECT_EQ(other[i].R, found[0][i].R);
      EXPECT_EQ(other[i].t_m, found[0][i].t_m);
      EXPECT_EQ(other[i].score, found[0][i].score);
    }
  }
}

TEST_F(ThreeBlocks, AreExplainedOnceEach) {
  auto found = find_hypotheses(grid_, verifier_, parts_, parameters_);
  EXPECT_GT(found.poses.size(), 3U);
  const auto explained = explain_all(std::move(found.poses)).parts;
  ASSERT_EQ(explained.size(), 3U);
  std::vector<bool> is_claimed(grid_.size(), false);
  for (const ExplainedPart& part : explained) {
    EXPECT_LT(off_m(part.pose), 0.003);
    EXPECT_GT(part.cells.size(), 100U);
    for (const std::size_t cell : part.cells) {
      EXPECT_FALSE(is_claimed[cell]) << "two parts explain the same reading";
      is_claimed[cell] = true;
    }
  }
}

TEST_F(ThreeBlocks, AreNotFoundAgainInTheSameImage) {
  const auto found = find_hypotheses(grid_, verifier_, parts_, parameters_);
  Explanation explanation = explain_all(found.poses);
  explain(grid_, verifier_, scene_, found.poses, parameters_, never_late, explanation);
  EXPECT_EQ(explanation.parts.size(), 3U);
}

TEST_F(ThreeBlocks, NoneIsExplainedBelowTheFloor) {
  auto found = find_hypotheses(grid_, verifier_, parts_, parameters_);
  scene_.has_floor = true;  // 0.1 m too high, z up
  scene_.T_camera_floor.translation() = Vector3d(0, 0, kFloor_m - 0.1);
  scene_.T_camera_floor.linear() = Vector3d(1, -1, -1).asDiagonal();
  const auto [explained, refusal] = explain_all(std::move(found.poses));
  EXPECT_TRUE(explained.empty());
  ASSERT_TRUE(refusal);
  EXPECT_EQ(refusal->parameter, "max_below_floor_m");
  EXPECT_GT(refusal->value, 0.1);
}

TEST_F(ThreeBlocks, ASlabOfManyBlocksIsNone) {
  grid_ = testing::grid_of(
      {{Eigen::Isometry3d(Eigen::Translation3d(0, 0, 0.70)), Vector3d(0.3, 0.25, 0.03)}}, kFloor_m);
  auto found = find_hypotheses(grid_, verifier_, parts_, parameters_);
  const auto [explained, refusal] = explain_all(std::move(found.poses));
  EXPECT_TRUE(explained.empty());
  ASSERT_TRUE(refusal);
  EXPECT_EQ(refusal->parameter, "max_leftover_share");
  EXPECT_GT(refusal->value, parameters_.max_leftover_share);
}

TEST_F(ThreeBlocks, AreLessProbableAmongThingsThatNobodyAskedFor) {
  const auto weighed = [&] {
    auto found = find_hypotheses(grid_, verifier_, parts_, parameters_);
    Explanation explanation = explain_all(std::move(found.poses));
    const auto terms = terms_in_bin(grid_, verifier_, explanation);
    weigh_in_bin(grid_, verifier_, parameters_, explanation);
    return std::pair(terms, explanation.parts);
  };
  const auto [terms_alone, parts_alone] = weighed();
  // Bars, too narrow for a block.
  for (const double y_m : {-0.25, -0.21, -0.17, -0.13, -0.09, 0.09, 0.13, 0.17, 0.21, 0.25}) {
    blocks_.push_back({Eigen::Isometry3d(Eigen::Translation3d(0, y_m, 0.70)), {0.6, 0.02, 0.03}});
  }
  grid_ = testing::grid_of(blocks_, kFloor_m);
  const auto [terms, parts] = weighed();
  ASSERT_EQ(parts_alone.size(), 3U);
  ASSERT_EQ(parts.size(), 3U);
  EXPECT_GT(terms_alone[0].explained, 0.8F);
  EXPECT_LT(terms[0].explained, kExplainedEnough);
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_EQ(terms[i].alone, terms_alone[i].alone);
    EXPECT_LT(parts[i].pose.confidence, parts_alone[i].pose.confidence);
  }
}

TEST_F(ThreeBlocks, AreNoneWhereTheyAreTooImprobableInTheBin) {
  auto found = find_hypotheses(grid_, verifier_, parts_, parameters_);
  Explanation explanation = explain_all(std::move(found.poses));
  ASSERT_EQ(explanation.parts.size(), 3U);
  parameters_.min_confidence = 1.1;
  weigh_in_bin(grid_, verifier_, parameters_, explanation);
  EXPECT_TRUE(explanation.parts.empty());
  ASSERT_TRUE(explanation.refusal);
  EXPECT_EQ(explanation.refusal->parameter, "min_confidence");
  EXPECT_GT(explanation.refusal->value, 0.5);
}

}  // namespace
}  // namespace graspd::perception
