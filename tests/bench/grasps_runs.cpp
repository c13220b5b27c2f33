#include "grasps_runs.hpp"

#include <algorithm>
#include <ctime>
#include <limits>

#include "graspd/eval/evaluate.hpp"
#include "graspd/eval/pose_error.hpp"
#include "graspd/judge/grasp_search.hpp"
#include "graspd/perception/planner.hpp"
#include "graspd/simulation/bin_mesh.hpp"

namespace graspd::bench {
namespace {

constexpr int kTimedRuns = 5;
constexpr double kRightPoseShare = 0.1;  ///< of the diameter: as ./run bench accuracy
/// Of the second frame's noise, so that it is another.
constexpr std::uint64_t kSecondFrameSeed = 1'000'000;

/// What the planner is asked, and what is true.
struct Question {
  BopImage image;
  PlanRequest request;
  const parts::Catalogue& catalogue;
  const perception::Parameters& parameters;
  judge::GraspJudge judge;
};

judge::GraspJudge judge_of(const BopImage& image, const PlanRequest& request, double wall_m,
                           const parts::Catalogue& catalogue) {
  const Eigen::Isometry3d T_bin_camera = image.bin->T_camera_bin.inverse();
  std::vector<judge::TruePart> parts;
  for (const BopTruth& truth : image.truth) {
    parts.push_back({catalogue.find_bop(truth.obj_id), T_bin_camera * truth.T_camera_part});
  }
  return {std::move(parts), {image.bin->inner_size_m, wall_m}, request.gripper};
}

/// The true part that an object is, where its pose is right.
std::optional<std::size_t> true_part(const Object& object, const Question& question) {
  const parts::Part& part = *question.catalogue.find(object.part_id);
  const Eigen::Isometry3d T_bin_part =
      question.request.bin->T_base_bin.inverse() * object.T_base_part;
  const double right_m = kRightPoseShare * part.diameter_m;
  const auto& truth = question.judge.parts();
  for (std::size_t i = 0; i < truth.size(); ++i) {
    const Eigen::Vector3d error_m =
        (T_bin_part * part.barycentre_m) - (truth[i].T_bin_part * truth[i].part->barycentre_m);
    // The barycentre moves by no more than the farthest vertex.
    if (truth[i].part != &part || error_m.norm() > right_m) continue;
    if (eval::mssd_m(part, T_bin_part, truth[i].T_bin_part) <= right_m) return i;
  }
  return std::nullopt;
}

std::string cause_of(const judge::Judgement& judgement, std::optional<std::size_t> target) {
  using judge::Finding;
  if (judgement.finding == Finding::kGood) return std::string(name_of(Finding::kGood));
  if (!target) return "wrong_pose";
  if (judgement.finding == Finding::kCollisionPart && judgement.part == target) return "too_wide";
  return std::string(name_of(judgement.finding));
}

JudgedGrasp judge_grasp(const Grasp& grasp, const PlanAnswer& answer, const Question& question) {
  const Eigen::Isometry3d T_bin_base = question.request.bin->T_base_bin.inverse();
  const judge::Judgement judgement = question.judge.judge(
      {T_bin_base * grasp.T_base_grasp, grasp.opening_width_m, grasp.standoff_m});
  const auto object = std::ranges::find(answer.objects, grasp.object_id, &Object::id);
  const auto target = true_part(*object, question);
  JudgedGrasp judged;
  judged.object_id = grasp.object_id;
  judged.finding = judgement.finding;
  judged.cause = cause_of(judgement, target);
  judged.is_pose_right = target.has_value();
  if (judged.is_good()) {
    judged.held = judgement.part;
    judged.lifts_free = question.judge.lifts_free(*judged.held);
  }
  return judged;
}

struct TimedAnswer {
  PlanAnswer answer;
  double ms = 0;
};

/// Of this thread: work beside the bench does not count.
double cpu_ms() {
  std::timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) * 1e3 + static_cast<double>(now.tv_nsec) * 1e-6;
}

Result<TimedAnswer> timed_plan(const DepthFrame& frame, const PlanRequest& request,
                               const parts::Catalogue& catalogue,
                               const perception::Parameters& parameters) {
  const double start_ms = cpu_ms();
  auto answer = perception::plan(frame, request, catalogue, parameters);
  const double ms = cpu_ms() - start_ms;
  if (!answer) return tl::unexpected(answer.error());
  return TimedAnswer{*std::move(answer), ms};
}

JudgedPlan judge_plan(const TimedAnswer& timed, const Question& question) {
  JudgedPlan plan{timed.answer.outcome, {}};
  for (const Grasp& grasp : timed.answer.grasps) {
    plan.grasps.push_back(judge_grasp(grasp, timed.answer, question));
  }
  return plan;
}

double grasp_stage_ms(const PlanAnswer& answer) {
  const auto stage = std::ranges::find(answer.timings, "grasps", &StageTiming::stage);
  return static_cast<double>(stage->duration_ns) * 1e-6;
}

/// The true poses as the last plan, of which nothing has moved whatever the segments say: what is
/// planned on them is the grasp stage's alone.
Result<TimedAnswer> plan_from_truth(const Question& question) {
  PlanRequest request = question.request;
  LastPlan& truth = request.last_plan.emplace();
  for (const judge::TruePart& part : question.judge.parts()) {
    LastObject& object = truth.objects.emplace_back();
    object.id = static_cast<std::uint32_t>(truth.objects.size());
    object.part_id = part.part->id;
    object.T_base_part = request.bin->T_base_bin * part.T_bin_part;
    object.p_base_segment_centroid_m = object.T_base_part * part.part->barycentre_m;
  }
  perception::Parameters parameters = question.parameters;
  parameters.displacement.check = perception::DisplacementCheck::kCentroids;
  parameters.displacement.threshold_m = std::numeric_limits<double>::max();
  return timed_plan(question.image.frame, request, question.catalogue, parameters);
}

std::vector<ScoredPart> scored_parts(const PlanAnswer& from_truth, const judge::GraspJudge& judge) {
  std::vector<ScoredPart> scored;
  for (const Object& object : from_truth.objects) {
    scored.push_back({object.grs.grs, judge.lifts_free(object.id - 1)});
  }
  return scored;
}

DepthFrame frame_without(std::size_t taken, const Question& question, const Pile& pile) {
  const parts::Mesh bin = simulation::bin_mesh(pile.scene.bin_inner_size_m, pile.scene.bin_wall_m);
  const Eigen::Isometry3d T_camera_bin = question.image.bin->T_camera_bin;
  std::vector<simulation::SceneObject> scene{{&bin, T_camera_bin}};
  const auto& parts = question.judge.parts();
  for (std::size_t i = 0; i < parts.size(); ++i) {
    if (i == taken) continue;
    scene.push_back({&parts[i].part->mesh, T_camera_bin * parts[i].T_bin_part, pile.scene.gloss});
  }
  const simulation::Walls walls{T_camera_bin, pile.scene.bin_inner_size_m};
  return simulation::observe(scene, pile.scene.sensor, pile.scene.seed + kSecondFrameSeed, &walls);
}

Result<AfterPick> measure_after_pick(const PlanAnswer& before, std::size_t taken,
                                     const Question& question, const Pile& pile) {
  const DepthFrame frame = frame_without(taken, question, pile);
  PlanRequest request = question.request;
  LastPlan& last = request.last_plan.emplace();
  last.picked_object_id = before.grasps.front().object_id;
  for (const Object& object : before.objects) {
    last.objects.push_back({object.id, object.part_id, object.T_base_part,
                            object.p_base_segment_centroid_m, object.score,
                            object.visible_fraction});
  }
  const auto with = timed_plan(frame, request, question.catalogue, question.parameters);
  const auto anew = timed_plan(frame, question.request, question.catalogue, question.parameters);
  if (!with) return tl::unexpected(with.error());
  if (!anew) return tl::unexpected(anew.error());
  return AfterPick{with->answer.outcome == Outcome::kUnchanged, with->ms, anew->ms};
}

bool has_good(const JudgedPlan& plan) {
  return std::ranges::any_of(plan.grasps, &JudgedGrasp::is_good);
}

std::optional<bool> has_good_grasp(const JudgedPile& judged, const judge::GraspJudge& judge) {
  if (has_good(judged.descending) || has_good(judged.ascending) || has_good(judged.from_truth)) {
    return true;
  }
  const judge::SearchResult found = judge::find_good_grasp(judge);
  if (!found.is_complete) return std::nullopt;
  return found.grasp.has_value();
}

}  // namespace

std::vector<JudgedGrasp> JudgedPlan::first_of_objects() const {
  std::vector<JudgedGrasp> first;
  for (const JudgedGrasp& grasp : grasps) {
    if (std::ranges::find(first, grasp.object_id, &JudgedGrasp::object_id) == first.end()) {
      first.push_back(grasp);
    }
  }
  return first;
}

Result<JudgedPile> judge_pile(const Pile& pile, const parts::Catalogue& catalogue,
                              const perception::Parameters& parameters) {
  const auto maker = simulation::SceneMaker::create(catalogue, pile.scene);
  if (!maker) return tl::unexpected(maker.error());
  const auto image = maker->make(0);
  if (!image) return tl::unexpected(image.error());
  const PlanRequest request = eval::request_for(*image, catalogue, {pile.part->id});
  Question question{*image, request, catalogue, parameters,
                    judge_of(*image, request, pile.scene.bin_wall_m, catalogue)};

  const auto descending = timed_plan(image->frame, request, catalogue, parameters);
  if (!descending) return tl::unexpected(descending.error());
  PlanRequest reversed = request;
  reversed.options.order = GraspOrder::kAscending;
  const auto ascending = timed_plan(image->frame, reversed, catalogue, parameters);
  if (!ascending) return tl::unexpected(ascending.error());
  const auto from_truth = plan_from_truth(question);
  if (!from_truth) return tl::unexpected(from_truth.error());

  JudgedPile judged;
  judged.pile = pile;
  judged.descending = judge_plan(*descending, question);
  judged.ascending = judge_plan(*ascending, question);
  judged.from_truth = judge_plan(*from_truth, question);
  judged.scored = scored_parts(from_truth->answer, question.judge);
  judged.grasp_stage_ms = grasp_stage_ms(from_truth->answer);
  for (int i = 1; i < kTimedRuns; ++i) {
    judged.grasp_stage_ms =
        std::min(judged.grasp_stage_ms, grasp_stage_ms(plan_from_truth(question)->answer));
  }
  judged.has_good_grasp = has_good_grasp(judged, question.judge);
  if (!judged.descending.grasps.empty() && judged.descending.grasps.front().held) {
    const auto after =
        measure_after_pick(descending->answer, *judged.descending.grasps[0].held, question, pile);
    if (!after) return tl::unexpected(after.error());
    judged.after_pick = *after;
  }
  return judged;
}

}  // namespace graspd::bench
