#include "graspd/eval/pose_accuracy.hpp"

#include <algorithm>
#include <iterator>

#include "graspd/eval/quantile.hpp"
#include "graspd/eval/visibility.hpp"

namespace graspd::eval {
namespace {

constexpr double kMaxMssdShare = 0.1;
constexpr int kFirstBin_tenths = 5;

bool is_counted(const PosedAnswer& answer) { return answer.verdict != Verdict::kIgnored; }
bool is_right(const PosedAnswer& answer) { return answer.verdict == Verdict::kRight; }

double ratio(int part_n, int whole_n) { return whole_n == 0 ? 0 : double(part_n) / whole_n; }

std::optional<Spread> spread(const std::vector<PosedAnswer>& answers, double PoseError::*error) {
  std::vector<double> values;
  for (const PosedAnswer& answer : answers) {
    if (is_right(answer)) values.push_back(answer.error.*error);
  }
  if (values.empty()) return std::nullopt;
  return Spread{quantile(values, 0.5), quantile(values, 0.9)};
}

struct Match {
  std::size_t object = 0;  ///< in the image's truth
  PoseError error;
};

/// The nearest object of the same part that is not yet taken, where it is near enough.
std::optional<Match> nearest_object(const BopResult& result, const parts::Part& part,
                                    std::span<const BopTruth> truth,
                                    const std::vector<bool>& is_taken) {
  double least_m = kMaxMssdShare * part.diameter_m;
  std::optional<std::size_t> nearest;
  for (std::size_t i = 0; i < truth.size(); ++i) {
    if (is_taken[i] || truth[i].obj_id != result.obj_id) continue;
    // The barycentre lies among the vertices: the farthest of them is at least as far off.
    const Eigen::Vector3d apart_m =
        truth[i].T_camera_part * part.barycentre_m - result.T_camera_part * part.barycentre_m;
    if (apart_m.norm() > least_m) continue;
    const double error_m = mssd_m(part, result.T_camera_part, truth[i].T_camera_part);
    if (error_m >= least_m) continue;
    least_m = error_m;
    nearest = i;
  }
  if (!nearest) return std::nullopt;
  return Match{*nearest, pose_error(part, result.T_camera_part, truth[*nearest].T_camera_part)};
}

}  // namespace

PoseAccuracy& PoseAccuracy::operator+=(const PoseAccuracy& other) {
  answers.insert(answers.end(), other.answers.begin(), other.answers.end());
  objects.insert(objects.end(), other.objects.begin(), other.objects.end());
  return *this;
}

PoseAccuracy PoseAccuracy::of_part(int obj_id) const {
  PoseAccuracy part;
  const auto is_of_part = [&](const auto& record) { return record.obj_id == obj_id; };
  std::copy_if(answers.begin(), answers.end(), std::back_inserter(part.answers), is_of_part);
  std::copy_if(objects.begin(), objects.end(), std::back_inserter(part.objects), is_of_part);
  return part;
}

int PoseAccuracy::found_n() const {
  return static_cast<int>(std::count_if(objects.begin(), objects.end(),
                                        [](const TrueObject& object) { return object.is_found; }));
}

int PoseAccuracy::answers_n() const {
  return static_cast<int>(std::count_if(answers.begin(), answers.end(), is_counted));
}

int PoseAccuracy::right_n() const {
  return static_cast<int>(std::count_if(answers.begin(), answers.end(), is_right));
}

double PoseAccuracy::recall() const { return ratio(found_n(), objects_n()); }

double PoseAccuracy::precision() const { return ratio(right_n(), answers_n()); }

std::vector<CurvePoint> PoseAccuracy::curve() const {
  std::vector<PosedAnswer> best_first;
  std::copy_if(answers.begin(), answers.end(), std::back_inserter(best_first), is_counted);
  std::sort(best_first.begin(), best_first.end(),
            [](const auto& a, const auto& b) { return a.score > b.score; });
  std::vector<CurvePoint> points;
  int right = 0;
  for (std::size_t i = 0; i < best_first.size(); ++i) {
    right += is_right(best_first[i]);
    // No threshold parts answers of one score.
    const bool is_last = i + 1 == best_first.size();
    if (!is_last && best_first[i + 1].score == best_first[i].score) continue;
    points.push_back(
        {best_first[i].score, ratio(right, static_cast<int>(i) + 1), ratio(right, objects_n())});
  }
  return points;
}

double PoseAccuracy::average_precision() const {
  double area = 0;
  double reached = 0;
  for (const CurvePoint& point : curve()) {
    area += (point.recall - reached) * point.precision;
    reached = point.recall;
  }
  return area;
}

std::optional<Spread> PoseAccuracy::translation_error_m() const {
  return spread(answers, &PoseError::translation_m);
}

std::optional<Spread> PoseAccuracy::rotation_error_rad() const {
  return spread(answers, &PoseError::rotation_rad);
}

std::vector<VisibilityBin> PoseAccuracy::by_visibility() const {
  std::vector<VisibilityBin> bins;
  for (int tenths = kFirstBin_tenths; tenths < 10; ++tenths) {
    VisibilityBin bin{tenths / 10.0, (tenths + 1) / 10.0, {}};
    const auto is_inside = [&](double visible_fraction) {
      return visible_fraction >= bin.from && (visible_fraction < bin.to || tenths == 9);
    };
    for (const PosedAnswer& answer : answers) {
      if (is_right(answer) && is_inside(answer.visible_fraction)) {
        bin.accuracy.answers.push_back(answer);
      }
    }
    for (const TrueObject& object : objects) {
      if (is_inside(object.visible_fraction)) bin.accuracy.objects.push_back(object);
    }
    bins.push_back(std::move(bin));
  }
  return bins;
}

PoseAccuracy pose_accuracy(std::span<const BopResult> results, const BopImage& image,
                           const parts::Catalogue& catalogue) {
  std::vector<BopResult> best_first(results.begin(), results.end());
  std::stable_sort(best_first.begin(), best_first.end(),
                   [](const auto& a, const auto& b) { return a.score > b.score; });
  std::vector<bool> is_taken(image.truth.size());
  PoseAccuracy accuracy;
  for (const BopResult& result : best_first) {
    PosedAnswer answer{image.im_id, result.obj_id, result.score, Verdict::kWrong, 0, {}};
    if (const auto match =
            nearest_object(result, *catalogue.find_bop(result.obj_id), image.truth, is_taken)) {
      is_taken[match->object] = true;
      answer.visible_fraction = image.truth[match->object].visible_fraction;
      answer.verdict = answer.visible_fraction >= kMinVisible ? Verdict::kRight : Verdict::kIgnored;
      answer.error = match->error;
    }
    accuracy.answers.push_back(answer);
  }
  for (std::size_t i = 0; i < image.truth.size(); ++i) {
    const BopTruth& truth = image.truth[i];
    if (truth.visible_fraction < kMinVisible) continue;
    accuracy.objects.push_back({image.im_id, truth.obj_id, truth.visible_fraction, is_taken[i]});
  }
  return accuracy;
}

}  // namespace graspd::eval
