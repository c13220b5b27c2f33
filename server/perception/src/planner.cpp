#include "graspd/perception/planner.hpp"

#include <algorithm>
#include <chrono>
#include <iterator>

#include "check_request.hpp"
#include "grasp_stage.hpp"
#include "graspd/perception/bin_drift.hpp"
#include "graspd/perception/organised.hpp"
#include "graspd/perception/outline.hpp"
#include "graspd/perception/preprocess.hpp"
#include "graspd/perception/registration.hpp"
#include "graspd/perception/segmentation.hpp"
#include "graspd/perception/verified.hpp"
#include "last_plan.hpp"
#include "missing_readings.hpp"
#include "parallel.hpp"
#include "why_none.hpp"

namespace graspd::perception {
namespace {

/// A bare floor has next to no points above it: those that noise and bowed walls leave.
constexpr double kClutterShare = 0.1;

/// Times the pipeline's stages into the answer.
class StageClock {
 public:
  explicit StageClock(std::vector<StageTiming>& timings) : timings_(timings) {}
  void finished(const char* stage) {
    const auto now = std::chrono::steady_clock::now();
    timings_.push_back({stage, std::chrono::nanoseconds(now - last_).count()});
    last_ = now;
  }

 private:
  std::vector<StageTiming>& timings_;
  std::chrono::steady_clock::time_point last_ = std::chrono::steady_clock::now();
};

/// The request's own choices over the server's.
Parameters effective(const PlanOptions& options, Parameters parameters) {
  const auto choose = [](auto asked, auto& parameter) {
    if (asked != decltype(asked)::kServerDefault) parameter = asked;
  };
  choose(options.segmentation, parameters.segmentation.method);
  choose(options.registration, parameters.registration.method);
  choose(options.order, parameters.grs.order);
  choose(options.p_system, parameters.grs.p_system);
  if (options.max_grasps_n > 0) {
    parameters.grasp.max_grasps_n = static_cast<int>(options.max_grasps_n);
  }
  return parameters;
}

double largest_diameter_m(const PartList& parts) {
  double largest_m = 0;
  for (const parts::Part* part : parts) largest_m = std::max(largest_m, part->diameter_m);
  return largest_m;
}

Object make_object(std::uint32_t id, const std::string& part_id,
                   const Eigen::Isometry3d& T_base_part,
                   const Eigen::Vector3d& p_base_segment_centroid_m, const Evidence& evidence) {
  Object object;
  object.id = id;
  object.part_id = part_id;
  object.T_base_part = T_base_part;
  object.p_base_segment_centroid_m = p_base_segment_centroid_m;
  object.score = evidence.score;
  object.visible_fraction = evidence.visible_fraction;
  object.inlier_fraction = evidence.inlier_fraction;
  object.refuted_fraction = evidence.refuted_fraction;
  object.rms_m = evidence.rms_m;
  return object;
}

std::vector<Object> objects_from(const RegistrationResult& result,
                                 const Eigen::Isometry3d& T_base_camera) {
  std::vector<Object> objects;
  for (const RegisteredPart& part : result.parts) {
    const auto id = static_cast<std::uint32_t>(objects.size() + 1);
    objects.push_back(make_object(id, part.part->id, T_base_camera * part.T_camera_part,
                                  T_base_camera * part.p_camera_segment_centroid_m, part.evidence));
  }
  return objects;
}

/// The last plan's objects as they stand, with today's evidence.
std::vector<Object> objects_from(const std::vector<StandingObject>& standing) {
  std::vector<Object> objects;
  for (const auto& [last, evidence] : standing) {
    objects.push_back(make_object(last.id, last.part_id, last.T_base_part,
                                  last.p_base_segment_centroid_m, evidence));
  }
  return objects;
}

tl::unexpected<Error> too_late(const std::vector<StageTiming>& timings) {
  std::vector<std::string> stages;
  for (const auto& [stage, duration_ns] : timings) {
    stages.push_back(fmt::format("{} {:.1f} ms", stage, static_cast<double>(duration_ns) * 1e-6));
  }
  return fail(Code::kDeadlineExceeded, "the request's budget ended while it was computed ({})",
              fmt::join(stages, ", "));
}

void finish(PlanAnswer& answer, Outcome outcome, std::string reason) {
  answer.outcome = outcome;
  answer.reason = std::move(reason);
}

/// Registers the parts in the segments. Where there are none, the answer's reason says why.
std::vector<Object> register_objects(const DepthFrame& frame, const PlanRequest& request,
                                     Scene& scene, const std::vector<Indices>& segments,
                                     const PartList& parts, const Parameters& parameters,
                                     const IsLate& is_late, PlanAnswer& answer) {
  const RegistrationResult registered =
      parameters.registration.method == Registration::kVerified
          ? register_verified(frame, scene, segments, parts, parameters, is_late)
          : register_segments(frame, scene, segments, parts, parameters.registration, is_late);
  answer.funnel.hypotheses_n = registered.hypotheses_n;
  answer.funnel.rejected_score_n = registered.rejected_score_n;
  if (registered.parts.empty()) {
    answer.reason = why_none(segments.size(), registered, parameters.registration);
  }
  return objects_from(registered, request.T_base_camera);
}

void draw_outlines(const DepthFrame& frame, const PlanRequest& request,
                   const parts::Catalogue& catalogue, std::vector<Object>& objects) {
  for (Object& object : objects) {
    object.outline_px = outline_px(frame.camera, catalogue.find(object.part_id)->mesh,
                                   request.T_base_camera.inverse() * object.T_base_part);
  }
}

/// The scene, and what the answer says of it.
Scene look(const DepthFrame& frame, const PlanRequest& request, const PartList& parts,
           const Parameters& parameters, PlanAnswer& answer) {
  Scene scene = prepare_readings(frame, request, largest_diameter_m(parts), parameters);
  if (!scene.seen) scene.seen = seen_in_workspace(frame, request, parameters.preprocess);
  answer.funnel = scene.funnel;
  answer.fill_level = scene.fill_level;
  answer.warnings = scene.warnings;
  if (auto warning = missing_readings(frame, request)) answer.warnings.push_back(*warning);
  std::ranges::move(too_small_parts(parts, frame.camera, scene.T_camera_floor.translation().norm(),
                                    parameters.registration.min_explained_px),
                    std::back_inserter(answer.warnings));
  return scene;
}

/// How far the bin lies from where the request says, as far as its walls tell.
std::optional<BinDrift> drift_of_bin(const DepthFrame& frame, const PlanRequest& request,
                                     const PreprocessParameters& parameters) {
  if (!request.bin) return std::nullopt;
  return find_bin_drift(frame, request.T_base_camera.inverse() * request.bin->T_base_bin,
                        request.bin->inner_size_m, parameters);
}

/// A bin that lies elsewhere is warned of.
/// \returns why there is none to plan in, where nothing of it is seen or it lies too far away.
std::optional<std::string> misplaced_bin(const Scene& scene, const std::optional<BinDrift>& drift,
                                         const PreprocessParameters& parameters,
                                         std::vector<std::string>& warnings) {
  if (scene.funnel.after_passthrough_n == 0) {
    return fmt::format(
        "none of the {} readings lies where the request says the bin is; check "
        "T_base_camera, T_base_bin and the intrinsics",
        scene.funnel.readings_n);
  }
  if (!drift || drift->corner_m <= parameters.bin_drift_warning_m) return std::nullopt;
  if (drift->corner_m > parameters.max_bin_drift_m) return sentence_of(*drift);
  warnings.push_back(sentence_of(*drift));
  return std::nullopt;
}

/// Where nothing hangs together: a bare floor, or readings that are no surface.
void finish_without_segments(const Funnel& funnel, PlanAnswer& answer) {
  if (funnel.after_plane_n > kClutterShare * funnel.after_voxel_grid_n) {
    finish(answer, Outcome::kNoneRegistered,
           fmt::format("{} of {} points lie above the floor, but no part's worth of them hangs "
                       "together: they are noise, or no surface; check the camera",
                       funnel.after_plane_n, funnel.after_voxel_grid_n));
  } else {
    finish(answer, Outcome::kBinEmpty,
           fmt::format("{} points lie above the floor, too few for a part", funnel.after_plane_n));
  }
}

enum class Found {
  kNothing,   ///< the answer is finished
  kLastPlan,  ///< its remaining objects stand
  kAnew,
};

/// Finds the objects: in segments, or where the centroids of these say that the last plan stands.
Result<Found> find_objects(const DepthFrame& frame, const PlanRequest& request,
                           const parts::Catalogue& catalogue, const PartList& parts,
                           const LastPlan* last_plan, const Parameters& parameters,
                           const IsLate& is_late, StageClock& clock, Scene& scene,
                           PlanAnswer& answer) {
  if (is_late()) return too_late(answer.timings);
  if (scene.grid) add_normals(scene);
  const std::vector<Indices> segments =
      segment(scene.cloud, parts, parameters.preprocess, parameters.segmentation);
  answer.funnel.segments_n = static_cast<std::uint32_t>(segments.size());
  if (scene.grid) drop_islands_without_segments(segments, scene);
  clock.finished("segmentation");
  if (segments.empty()) {
    finish_without_segments(scene.funnel, answer);
    return Found::kNothing;
  }

  if (is_late()) return too_late(answer.timings);
  const auto standing =
      standing_by_centroids(last_plan, frame, request, scene, segments, catalogue, parameters);
  answer.objects = standing.empty() ? register_objects(frame, request, scene, segments, parts,
                                                       parameters, is_late, answer)
                                    : objects_from(standing);
  clock.finished("registration");
  if (is_late()) return too_late(answer.timings);
  if (answer.objects.empty()) {
    answer.outcome = Outcome::kNoneRegistered;  // the reason stands already
    return Found::kNothing;
  }
  return standing.empty() ? Found::kAnew : Found::kLastPlan;
}

}  // namespace

Result<PlanAnswer> plan(const DepthFrame& frame, const PlanRequest& request,
                        const parts::Catalogue& catalogue, const Parameters& server_parameters,
                        const IsLate& is_late) {
  const Parameters parameters = effective(request.options, server_parameters);
  const auto parts = check_request(frame, request, catalogue);
  if (!parts) return tl::unexpected(parts.error());
  PlanAnswer answer;
  StageClock clock(answer.timings);

  Scene scene;
  std::optional<BinDrift> drift;
  parallel_invoke([&] { scene = look(frame, request, *parts, parameters, answer); },
                  [&] { drift = drift_of_bin(frame, request, parameters.preprocess); });
  if (drift) answer.bin_drift_m = drift->corner_m;
  const auto nowhere = misplaced_bin(scene, drift, parameters.preprocess, answer.warnings);
  clock.finished("preprocess");
  if (nowhere) {
    finish(answer, Outcome::kBinNotFound, *nowhere);
    return answer;
  }

  if (is_late()) return too_late(answer.timings);
  const LastPlan* const last_plan = comparable_last_plan(request, answer.warnings);
  answer.objects =
      objects_from(standing_by_readings(last_plan, request, scene, catalogue, parameters));
  bool is_unchanged = !answer.objects.empty();
  clock.finished("displacement");
  const auto plan_on_objects = [&] {
    plan_grasps(request, catalogue, parameters, scene, answer);
    clock.finished("grasps");
  };
  if (is_unchanged) plan_on_objects();
  if (answer.grasps.empty()) {
    // Of what stands, nothing can be grasped: what came to light since may be.
    forget_objects(answer);
    const auto found = find_objects(frame, request, catalogue, *parts, last_plan, parameters,
                                    is_late, clock, scene, answer);
    if (!found) return tl::unexpected(found.error());
    if (*found == Found::kNothing) return answer;
    is_unchanged = *found == Found::kLastPlan;
    plan_on_objects();
  }
  if (is_late()) return too_late(answer.timings);
  if (request.options.outlines) {
    draw_outlines(frame, request, catalogue, answer.objects);
    clock.finished("outlines");
  }
  conclude(answer, request.options, is_unchanged, parameters);
  return answer;
}

}  // namespace graspd::perception
