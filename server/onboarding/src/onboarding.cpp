#include "graspd/onboarding/onboarding.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <thread>

#include "graspd/eval/interval.hpp"
#include "graspd/eval/quantile.hpp"

namespace graspd::onboarding {
namespace {

/// Of the piles, those whose best grasp is of a part in its true pose.
constexpr double kGoodShare = 0.8;
constexpr double kFairShare = 0.5;
/// Below these, something can be done about it.
constexpr double kLowRecall = 0.6;
constexpr double kLowPrecision = 0.8;
constexpr double kManyRejected = 0.3;
/// By how much nearer a camera is worth trying.
constexpr double kNearerShare = 0.8;

double share(int hits_n, int all_n) { return all_n == 0 ? 0 : static_cast<double>(hits_n) / all_n; }
std::string percent(double share) { return fmt::format("{:.0f} %", 100 * share); }

std::string between(int hits_n, int all_n) {
  const eval::Interval interval = eval::wilson(hits_n, all_n);
  return fmt::format("{:.0f} to {:.0f} %", 100 * interval.low, 100 * interval.high);
}

/// What is wrong with this topic, as the mesh's check says it.
const parts::MeshFinding* fault_of(const Onboarding& onboarding, std::string_view topic) {
  const auto found = std::ranges::find_if(onboarding.findings, [&](const auto& finding) {
    return finding.topic == topic && finding.severity != parts::Severity::kOk;
  });
  return found == onboarding.findings.end() ? nullptr : &*found;
}

/// What the camera can't resolve; or the size that is none of a part.
const parts::MeshFinding* unresolved(const Onboarding& onboarding) {
  const auto* units = fault_of(onboarding, "units");
  return units != nullptr ? units : fault_of(onboarding, "size");
}

std::vector<double> openings_m(const Onboarding& onboarding) {
  std::vector<double> all;
  for (const auto& point : jaw_points_of(onboarding.part)) {
    all.push_back(opening_for(point, onboarding.options.gripper));
  }
  std::ranges::sort(all);
  return all;
}

std::string counts_sentence(const Onboarding& onboarding) {
  const Forecast& forecast = onboarding.forecast;
  const eval::PoseAccuracy poses = forecast.poses();
  return fmt::format(
      "in {} of {} simulated piles the best grasp is of a part in its true pose; of the parts that "
      "show half of themselves or more {} are found, and {} can be grasped at once",
      forecast.first_right_n(), forecast.piles.size(), percent(poses.recall()),
      percent(share(forecast.pickable_n(), poses.objects_n())));
}

/// \param said by the verdict already
void advise_camera(const Onboarding& onboarding, const parts::MeshFinding* said,
                   std::vector<std::string>& advice) {
  for (const auto& finding : onboarding.findings) {
    const bool is_of_camera = finding.topic == "size" || finding.topic == "walls";
    if (is_of_camera && &finding != said && finding.severity != parts::Severity::kOk)
      advice.push_back(finding.sentence);
  }
  if (said != nullptr) return;
  const auto& scene = onboarding.options.scene;
  const double nearest_m = scene.sensor.min_depth_m + scene.bin_inner_size_m.z();
  const double nearer_m = std::max(nearest_m, kNearerShare * scene.camera_height_m);
  const eval::PoseAccuracy poses = onboarding.forecast.poses();
  if (poses.recall() >= kLowRecall && poses.precision() >= kLowPrecision) return;
  if (nearer_m < 0.95 * scene.camera_height_m) {
    advice.push_back(fmt::format(
        "Poses are {}: try the camera at {:.2f} m above the bin's floor in place of {:.2f} m "
        "(--distance-m {:.2f}); it sees the part {:.0f} % larger.",
        poses.recall() < kLowRecall ? "often not found" : "often wrong", nearer_m,
        scene.camera_height_m, nearer_m, 100 * (scene.camera_height_m / nearer_m - 1)));
  }
  if (poses.precision() < kLowPrecision) {
    advice.push_back(
        "Where the mesh looks alike from two sides but the part does not (or the other way round), "
        "say so in part.yaml under symmetries: a pose turned by them counts as wrong, or as "
        "right.");
  }
}

void advise_gripper(const Onboarding& onboarding, std::vector<std::string>& advice) {
  const Gripper& gripper = onboarding.options.gripper;
  const std::vector<double> needed_m = openings_m(onboarding);
  const auto too_wide_n = std::ranges::count_if(
      needed_m, [&](double opening_m) { return opening_m > gripper.max_opening_m; });
  if (too_wide_n > 0) {
    advice.push_back(fmt::format(
        "{} of {} pick points for jaws take an opening of up to {:.0f} mm; this gripper opens to "
        "{:.0f} mm.",
        too_wide_n, needed_m.size(), needed_m.back() * 1e3, gripper.max_opening_m * 1e3));
  }
  std::array<std::uint64_t, std::size(EnumNames<Check>::values)> rejected{};
  for (const PileForecast& pile : onboarding.forecast.piles) {
    for (std::size_t i = 0; i < rejected.size(); ++i) rejected[i] += pile.rejected_by_check_n[i];
  }
  const auto all = std::reduce(rejected.begin(), rejected.end(), std::uint64_t{0});
  const eval::PoseAccuracy poses = onboarding.forecast.poses();
  const double lost = share(poses.found_n() - onboarding.forecast.pickable_n(), poses.found_n());
  if (all == 0 || lost < kManyRejected) return;
  const auto most = std::ranges::max_element(rejected) - rejected.begin();
  constexpr std::array<const char*, std::size(EnumNames<Check>::values)> kRemedies{
      "they take a wider opening than the gripper has",
      "the gripper would meet other parts there: narrower jaws and a smaller palm get in between",
      "the gripper would meet other parts there: narrower jaws and a smaller palm get in between",
      "the gripper would meet the bin: longer jaws, or a wider bin, keep it clear of the walls",
      "the part would meet others on its way up: stirring the pile frees some"};
  advice.push_back(
      fmt::format("{} of the parts found have no grasp free of collisions. Most grasps are "
                  "rejected ({} of {}) because {}.",
                  percent(lost), rejected[static_cast<std::size_t>(most)], all,
                  kRemedies[static_cast<std::size_t>(most)]));
}

}  // namespace

double opening_for(const parts::PickPoint& point, const Gripper& gripper) {
  return point.width_m + 2 * gripper.clearance_m;
}

std::vector<parts::PickPoint> jaw_points_of(const parts::Part& part) {
  std::vector<parts::PickPoint> points;
  for (const parts::PickPoint& point : part.pick_points) {
    const bool is_known = std::ranges::any_of(
        points, [&](const parts::PickPoint& known) { return known.name == point.name; });
    if (!is_known && point.gripper != name_of(GripperKind::kSuction)) points.push_back(point);
  }
  return points;
}

Verdict verdict_of(const Onboarding& onboarding) {
  const std::string& id = onboarding.part.id;
  const std::vector<double> needed_m = openings_m(onboarding);
  const double stroke_m = onboarding.options.gripper.max_opening_m;
  if (needed_m.empty()) {
    return {Fitness::kPoor,
            fmt::format("Jaws find no hold on {}: no two of its surfaces face each other.", id)};
  }
  if (needed_m.front() > stroke_m) {
    return {Fitness::kPoor,
            fmt::format("This gripper can't grasp {}: its narrowest pick point takes an opening of "
                        "{:.0f} mm, and the jaws open to {:.0f} mm.",
                        id, needed_m.front() * 1e3, stroke_m * 1e3)};
  }
  if (const auto* finding = unresolved(onboarding)) {
    return {Fitness::kPoor,
            fmt::format("{} {}",
                        finding->topic == "units"
                            ? fmt::format("As it is, {} is no part for this cell.", id)
                            : fmt::format("This camera can't resolve {} here.", id),
                        finding->sentence)};
  }
  const double right = share(onboarding.forecast.first_right_n(),
                             static_cast<int>(onboarding.forecast.piles.size()));
  const std::string counts = counts_sentence(onboarding);
  if (right >= kGoodShare) {
    return {Fitness::kGood, fmt::format("This cell can pick {}: {}.", id, counts)};
  }
  if (right >= kFairShare) {
    return {Fitness::kFair, fmt::format("This cell can pick {}, with misses: {}.", id, counts)};
  }
  return {Fitness::kPoor, fmt::format("This cell can't pick {} as it is: {}.", id, counts)};
}

std::vector<std::string> advice_for(const Onboarding& onboarding) {
  std::vector<std::string> advice;
  const auto* const said = unresolved(onboarding);
  advise_camera(onboarding, said, advice);
  advise_gripper(onboarding, advice);
  const bool is_decimated = std::ranges::any_of(
      onboarding.findings, [](const auto& finding) { return finding.topic == "decimated"; });
  for (const auto& finding : onboarding.findings) {
    // Decimation makes edges of its own, which no CAD program has.
    const bool is_said = finding.topic == "size" || finding.topic == "walls" || &finding == said ||
                         (is_decimated && finding.topic == "edges");
    if (!is_said && finding.severity != parts::Severity::kOk) advice.push_back(finding.sentence);
  }
  const Forecast& forecast = onboarding.forecast;
  if (static_cast<int>(forecast.piles.size()) < forecast.asked_n) {
    const double all_s = forecast.duration_s * forecast.asked_n / double(forecast.piles.size());
    advice.push_back(fmt::format(
        "The forecast stopped after {} of {} piles, when its {:.0f} s were over: --limit-s {:.0f} "
        "gives this machine time for all of them, and narrower intervals.",
        forecast.piles.size(), forecast.asked_n, onboarding.options.limit_s,
        60 * std::ceil(all_s / 60)));
  }
  return advice;
}

std::vector<Figure> figures_of(const Onboarding& onboarding) {
  const Forecast& forecast = onboarding.forecast;
  const eval::PoseAccuracy poses = forecast.poses();
  const auto piles_n = static_cast<int>(forecast.piles.size());
  const int objects_n = poses.objects_n(), pickable_n = forecast.pickable_n();
  std::vector<Figure> figures{
      {"Piles with a right first grasp", percent(share(forecast.first_right_n(), piles_n)),
       between(forecast.first_right_n(), piles_n),
       fmt::format("{} pile{}", piles_n, piles_n == 1 ? "" : "s")},
      {"Parts found (recall)", percent(poses.recall()), between(poses.found_n(), objects_n),
       fmt::format("{} parts that show half or more", objects_n)},
      {"Answers right (precision)", percent(poses.precision()),
       between(poses.right_n(), poses.answers_n()), fmt::format("{} answers", poses.answers_n())},
      {"Parts pickable at once", percent(share(pickable_n, objects_n)),
       between(pickable_n, objects_n), "the same parts: found, and a grasp is free"}};
  if (const auto error = poses.translation_error_m()) {
    figures.push_back({"Position error", fmt::format("{:.1f} mm", error->median * 1e3), "",
                       fmt::format("median; nine in ten below {:.1f} mm", error->p90 * 1e3)});
  }
  const std::vector<double> used_m = forecast.openings_m();
  const double stroke_mm = onboarding.options.gripper.max_opening_m * 1e3;
  if (!used_m.empty()) {
    const auto [least, most] = std::ranges::minmax(used_m);
    figures.push_back({"Opening width", fmt::format("{:.0f} to {:.0f} mm", least * 1e3, most * 1e3),
                       "", fmt::format("best grasps; the jaws open to {:.0f} mm", stroke_mm)});
  }
  std::vector<double> plans_s;
  for (const PileForecast& pile : forecast.piles) plans_s.push_back(pile.plan_s);
  figures.push_back(
      {"Plan time", fmt::format("{:.0f} ms", eval::quantile(plans_s, 0.5) * 1e3), "",
       fmt::format("median, worst {:.0f} ms, on {} core(s) of this machine",
                   std::ranges::max(plans_s) * 1e3, std::thread::hardware_concurrency())});
  return figures;
}

}  // namespace graspd::onboarding
