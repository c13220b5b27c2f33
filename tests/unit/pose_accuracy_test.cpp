#include "graspd/eval/pose_accuracy.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <stdexcept>

#include "block_scene.hpp"
#include "graspd/eval/quantile.hpp"

namespace graspd::eval {
namespace {

TEST(Quantile, LiesBetweenTheValuesBesideIt) {
  EXPECT_EQ(quantile({7}, 0.9), 7);
  EXPECT_EQ(quantile({3, 1, 2}, 0.5), 2);
  EXPECT_EQ(quantile({4, 1, 2, 3}, 0.5), 2.5);
  EXPECT_NEAR(quantile({0, 10, 20, 30, 40}, 0.9), 36, 1e-12);
  EXPECT_EQ(quantile({5, 6}, 0), 5);
  EXPECT_EQ(quantile({5, 6}, 1), 6);
  EXPECT_THROW(quantile({}, 0.5), std::invalid_argument);
}

PosedAnswer answer(double score, Verdict verdict, double visible_fraction = 0, PoseError error = {},
                   int obj_id = 1) {
  return {0, obj_id, score, verdict, visible_fraction, error};
}

/// Five objects, three of them found by answers 1, 2 and 4 of four; an ignored one beside.
PoseAccuracy records() {
  PoseAccuracy accuracy;
  accuracy.answers = {answer(0.6, Verdict::kRight, 0.55, {0.004, 0.04}),
                      answer(0.9, Verdict::kRight, 0.95, {0.001, 0.01}),
                      answer(0.7, Verdict::kWrong),
                      answer(0.8, Verdict::kRight, 0.72, {0.002, 0.02}),
                      answer(0.95, Verdict::kIgnored, 0.3, {0.009, 0.09})};
  accuracy.objects = {{0, 1, 0.95, true},
                      {0, 1, 0.72, true},
                      {0, 1, 0.55, true},
                      {0, 1, 0.58, false},
                      {0, 2, 1.0, false}};
  return accuracy;
}

TEST(PoseAccuracy, CountsWithoutWhatIsIgnored) {
  const PoseAccuracy accuracy = records();
  EXPECT_EQ(accuracy.objects_n(), 5);
  EXPECT_EQ(accuracy.found_n(), 3);
  EXPECT_EQ(accuracy.answers_n(), 4);
  EXPECT_EQ(accuracy.right_n(), 3);
  EXPECT_NEAR(accuracy.recall(), 0.6, 1e-12);
  EXPECT_NEAR(accuracy.precision(), 0.75, 1e-12);
}

TEST(PoseAccuracy, DrawsItsCurveFromTheBestScoreDown) {
  const auto curve = records().curve();
  ASSERT_EQ(curve.size(), 4U);
  const double threshold[] = {0.9, 0.8, 0.7, 0.6};
  const double precision[] = {1, 1, 2.0 / 3, 3.0 / 4};
  const double recall[] = {0.2, 0.4, 0.4, 0.6};
  for (std::size_t i = 0; i < curve.size(); ++i) {
    EXPECT_EQ(curve[i].threshold, threshold[i]);
    EXPECT_NEAR(curve[i].precision, precision[i], 1e-12);
    EXPECT_NEAR(curve[i].recall, recall[i], 1e-12);
  }
}

TEST(PoseAccuracy, AveragesPrecisionOverTheStepsOfRecall) {
  // 0.2 · 1 + 0.2 · 1 + 0 · 2/3 + 0.2 · 3/4
  EXPECT_NEAR(records().average_precision(), 0.55, 1e-12);
  PoseAccuracy perfect;
  perfect.answers = {answer(0.4, Verdict::kRight, 0.9), answer(0.5, Verdict::kRight, 0.9)};
  perfect.objects = {{0, 1, 0.9, true}, {0, 1, 0.9, true}};
  EXPECT_NEAR(perfect.average_precision(), 1, 1e-12);
}

TEST(PoseAccuracy, TakesEqualScoresTogether) {
  PoseAccuracy accuracy;
  accuracy.answers = {answer(0.5, Verdict::kRight, 0.9), answer(0.5, Verdict::kWrong)};
  accuracy.objects = {{0, 1, 0.9, true}};
  for (int order = 0; order < 2; ++order) {
    ASSERT_EQ(accuracy.curve().size(), 1U);
    EXPECT_NEAR(accuracy.average_precision(), 0.5, 1e-12);
    std::swap(accuracy.answers[0], accuracy.answers[1]);
  }
}

TEST(PoseAccuracy, OfNothingIsZeroAndNoError) {
  const PoseAccuracy nothing;
  EXPECT_EQ(nothing.recall(), 0);
  EXPECT_EQ(nothing.precision(), 0);
  EXPECT_EQ(nothing.average_precision(), 0);
  EXPECT_TRUE(nothing.curve().empty());
  EXPECT_FALSE(nothing.translation_error_m().has_value());
  EXPECT_FALSE(nothing.rotation_error_rad().has_value());
}

TEST(PoseAccuracy, TakesErrorsOfTheRightAnswersAlone) {
  const auto translation_m = records().translation_error_m();
  ASSERT_TRUE(translation_m.has_value());
  EXPECT_NEAR(translation_m->median, 0.002, 1e-12);
  EXPECT_NEAR(translation_m->p90, 0.0036, 1e-12);  // 0.002 + 0.8 · 0.002
  const auto rotation_rad = records().rotation_error_rad();
  ASSERT_TRUE(rotation_rad.has_value());
  EXPECT_NEAR(rotation_rad->median, 0.02, 1e-12);
  EXPECT_NEAR(rotation_rad->p90, 0.036, 1e-12);
}

TEST(PoseAccuracy, FallsIntoBinsOfVisibility) {
  const auto bins = records().by_visibility();
  ASSERT_EQ(bins.size(), 5U);
  const int objects_n[] = {2, 0, 1, 0, 2};
  const int found_n[] = {1, 0, 1, 0, 1};
  for (std::size_t i = 0; i < bins.size(); ++i) {
    EXPECT_NEAR(bins[i].from, 0.5 + 0.1 * static_cast<double>(i), 1e-12);
    EXPECT_NEAR(bins[i].to, 0.6 + 0.1 * static_cast<double>(i), 1e-12);
    EXPECT_EQ(bins[i].accuracy.objects_n(), objects_n[i]) << "bin " << i;
    EXPECT_EQ(bins[i].accuracy.found_n(), found_n[i]) << "bin " << i;
    EXPECT_EQ(bins[i].accuracy.right_n(), found_n[i]) << "bin " << i;
  }
  EXPECT_NEAR(bins[0].accuracy.translation_error_m()->median, 0.004, 1e-12);
}

TEST(PoseAccuracy, OfAPartLeavesTheOthersOut) {
  EXPECT_EQ(records().of_part(1).objects_n(), 4);
  EXPECT_EQ(records().of_part(1).answers_n(), 4);
  EXPECT_EQ(records().of_part(2).objects_n(), 1);
  EXPECT_EQ(records().of_part(2).answers_n(), 0);
}

TEST(PoseAccuracy, AddsUpOverImagesWhateverTheirOrder) {
  PoseAccuracy twice = records();
  twice += records();
  EXPECT_EQ(twice.objects_n(), 10);
  EXPECT_NEAR(twice.average_precision(), records().average_precision(), 1e-12);
  std::shuffle(twice.answers.begin(), twice.answers.end(), std::mt19937(1));
  EXPECT_NEAR(twice.average_precision(), records().average_precision(), 1e-12);
}

/// Images of a block of 60 × 40 × 20 mm, whose diameter is 74.8 mm.
class Matching : public ::testing::Test {
 protected:
  static Eigen::Isometry3d at(double x_m) {
    return Eigen::Isometry3d(Eigen::Translation3d(x_m, 0, 0.7));
  }
  static BopResult result(double score, double x_m, int obj_id = 1) {
    return {0, 0, obj_id, score, at(x_m), 0};
  }
  PoseAccuracy measure(const std::vector<BopResult>& results) const {
    std::vector<parts::Part> parts{testing::block_part("block", {0.06, 0.04, 0.02}),
                                   testing::block_part("other", {0.06, 0.04, 0.02})};
    parts[1].bop_obj_id = 2;
    return pose_accuracy(results, image_, parts::Catalogue(std::move(parts)));
  }
  BopImage image_ = [] {
    BopImage image;
    image.im_id = 7;
    image.truth = {{1, at(0), 0.9}, {1, at(0.1), 0.5}, {1, at(0.2), 0.2}};
    return image;
  }();
};

TEST_F(Matching, CountsEachObjectOnceAndLeavesTheHiddenOut) {
  const PoseAccuracy accuracy =
      measure({result(0.6, 0.5), result(0.9, 0.001), result(0.8, 0.002), result(0.7, 0.2)});
  ASSERT_EQ(accuracy.answers.size(), 4U) << "best first";
  EXPECT_EQ(accuracy.answers[0].verdict, Verdict::kRight);
  EXPECT_EQ(accuracy.answers[1].verdict, Verdict::kWrong) << "the same object again";
  EXPECT_EQ(accuracy.answers[2].verdict, Verdict::kIgnored) << "hardly visible";
  EXPECT_EQ(accuracy.answers[3].verdict, Verdict::kWrong) << "nothing there";
  EXPECT_EQ(accuracy.answers[0].im_id, 7);
  EXPECT_EQ(accuracy.answers[0].visible_fraction, 0.9);
  EXPECT_NEAR(accuracy.answers[0].error.translation_m, 0.001, 1e-9);
  ASSERT_EQ(accuracy.objects.size(), 2U) << "half visible counts, less does not";
  EXPECT_TRUE(accuracy.objects[0].is_found);
  EXPECT_FALSE(accuracy.objects[1].is_found);
  EXPECT_NEAR(accuracy.recall(), 1.0 / 2, 1e-12);
  EXPECT_NEAR(accuracy.precision(), 1.0 / 3, 1e-12);
}

TEST_F(Matching, EndsAtATenthOfTheDiameter) {
  EXPECT_EQ(measure({result(0.9, 0.0074)}).right_n(), 1);
  EXPECT_EQ(measure({result(0.9, 0.0075)}).right_n(), 0);
}

TEST_F(Matching, TakesTheNearestObject) {
  image_.truth = {{1, at(0), 0.9}, {1, at(0.006), 0.8}};
  const PoseAccuracy accuracy = measure({result(0.9, 0.005), result(0.8, 0.005)});
  EXPECT_EQ(accuracy.answers[0].visible_fraction, 0.8);
  EXPECT_EQ(accuracy.answers[1].visible_fraction, 0.9) << "what the better answer left";
}

TEST_F(Matching, IsWithinAPart) {
  EXPECT_EQ(measure({result(0.9, 0, 2)}).answers[0].verdict, Verdict::kWrong);
}

}  // namespace
}  // namespace graspd::eval
