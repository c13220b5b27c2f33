#include "graspd/onboarding/forecast.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <deque>
#include <future>
#include <set>
#include <thread>

#include "graspd/eval/evaluate.hpp"
#include "graspd/simulation/convex_pieces.hpp"

namespace graspd::onboarding {
namespace {

using Clock = std::chrono::steady_clock;
using Progress = std::function<void(std::string_view, int, int)>;

constexpr int kFewestParts = 4;
constexpr int kMostParts = 60;
/// Of the bin's volume, that the parts' hulls take: a pile as high as half the walls, or more.
constexpr double kFillShare = 0.35;
/// More than any pile has, so that each part's grasps are in the answer.
constexpr std::uint32_t kAllGrasps = 1000;

double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

/// In order, on all cores. Fewer than asked for where the time is up.
Result<std::vector<BopImage>> make_piles(const simulation::SceneMaker& maker,
                                         const ForecastOptions& options, Clock::time_point start,
                                         const Progress& progress) {
  const auto cores_n = std::max(1U, std::thread::hardware_concurrency());
  std::deque<std::future<Result<BopImage>>> started;
  std::vector<BopImage> piles;
  for (int k = 0; k < options.piles_n || !started.empty();) {
    const bool has_time = k == 0 || seconds_since(start) < options.limit_s;
    if (!has_time && started.empty()) break;
    if (has_time && k < options.piles_n && started.size() < cores_n) {
      started.push_back(std::async(std::launch::async, [&maker, k] { return maker.make(k); }));
      ++k;
      continue;
    }
    auto pile = started.front().get();
    started.pop_front();
    if (!pile) return tl::unexpected(pile.error());
    piles.push_back(*std::move(pile));
    piles.back().instance.reset();  // segments are not what is asked for
    if (progress) progress("piles", static_cast<int>(piles.size()), options.piles_n);
  }
  return piles;
}

/// The results of objects that may be taken: scored by the same rule as all.
std::vector<BopResult> of_objects(const eval::ImageReport& report,
                                  const std::set<std::uint32_t>& object_ids) {
  std::vector<BopResult> results;
  for (std::size_t i = 0; i < report.results.size(); ++i) {
    if (object_ids.contains(report.answer.objects[i].id)) results.push_back(report.results[i]);
  }
  return results;
}

PileForecast forecast_of(const eval::ImageReport& report, const BopImage& image,
                         const parts::Catalogue& catalogue) {
  PileForecast pile;
  pile.parts_n = static_cast<int>(image.truth.size());
  pile.outcome = report.answer.outcome;
  pile.poses = report.poses.value_or(eval::PoseAccuracy{});
  pile.rejected_by_check_n = report.answer.funnel.rejected_by_check_n;
  pile.plan_s = report.time_s;
  std::set<std::uint32_t> graspable;
  for (const Grasp& grasp : report.answer.grasps) {
    if (graspable.insert(grasp.object_id).second) pile.openings_m.push_back(grasp.opening_width_m);
  }
  pile.pickable_n = eval::pose_accuracy(of_objects(report, graspable), image, catalogue).found_n();
  if (!report.answer.grasps.empty()) {
    const auto first = of_objects(report, {report.answer.grasps.front().object_id});
    // A part less than half visible counts for nothing in recall, but is picked as any other.
    const auto found = eval::pose_accuracy(first, image, catalogue);
    pile.is_first_right = std::ranges::none_of(found.answers, [](const eval::PosedAnswer& answer) {
      return answer.verdict == eval::Verdict::kWrong;
    });
  }
  return pile;
}

}  // namespace

eval::PoseAccuracy Forecast::poses() const {
  eval::PoseAccuracy all;
  for (const PileForecast& pile : piles) all += pile.poses;
  return all;
}

int Forecast::pickable_n() const {
  int sum = 0;
  for (const PileForecast& pile : piles) sum += pile.pickable_n;
  return sum;
}

int Forecast::first_right_n() const {
  return static_cast<int>(std::ranges::count_if(piles, &PileForecast::is_first_right));
}

std::vector<double> Forecast::openings_m() const {
  std::vector<double> all;
  for (const PileForecast& pile : piles) {
    all.insert(all.end(), pile.openings_m.begin(), pile.openings_m.end());
  }
  return all;
}

int parts_that_fit(const parts::Part& part, const Eigen::Vector3d& bin_inner_size_m) {
  const auto hull = simulation::convex_pieces(part.mesh, {.max_pieces_n = 1});
  const double fit = kFillShare * bin_inner_size_m.prod() / hull.front().volume_m3;
  return static_cast<int>(std::clamp<double>(std::floor(fit), kFewestParts, kMostParts));
}

Result<Forecast> forecast(const parts::Part& part, const ForecastOptions& options,
                          const Progress& progress) {
  const auto start = Clock::now();
  const Eigen::Vector3d& bin_m = options.scene.bin_inner_size_m;
  if (part.diameter_m > bin_m.head<2>().norm()) {
    return invalid(
        "bin: a part {:.0f} mm long does not lie flat in a bin of {:.0f} × {:.0f} mm; give the "
        "bin that it comes in",
        part.diameter_m * 1e3, bin_m.x() * 1e3, bin_m.y() * 1e3);
  }
  const parts::Catalogue catalogue({part});
  simulation::SceneOptions scene = options.scene;
  scene.parts = {{part.id, options.parts_n > 0 ? options.parts_n : parts_that_fit(part, bin_m)}};
  const auto maker = simulation::SceneMaker::create(catalogue, scene);
  if (!maker) return tl::unexpected(maker.error());
  const auto images = make_piles(*maker, options, start, progress);
  if (!images) return tl::unexpected(images.error());

  Forecast result;
  result.asked_n = options.piles_n;
  for (const BopImage& image : *images) {
    PlanRequest request = eval::request_for(image, catalogue, {part.id});
    request.gripper = options.gripper;
    request.options.max_grasps_n = kAllGrasps;
    const auto report = eval::evaluate_image(image, 0, request, catalogue, options.parameters);
    if (!report) return tl::unexpected(report.error());
    result.piles.push_back(forecast_of(*report, image, catalogue));
    if (result.piles.size() == 1) {
      request.options.outlines = true;
      auto drawn = eval::evaluate_image(image, 0, request, catalogue, options.parameters);
      if (!drawn) return tl::unexpected(drawn.error());
      result.picture = {image.frame, request, std::move(drawn->answer)};
    }
    if (progress)
      progress("plans", static_cast<int>(result.piles.size()), static_cast<int>(images->size()));
  }
  result.duration_s = seconds_since(start);
  return result;
}

}  // namespace graspd::onboarding
