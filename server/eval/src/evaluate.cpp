#include "graspd/eval/evaluate.hpp"

#include <algorithm>
#include <chrono>
#include <ctime>

#include "graspd/perception/planner.hpp"
#include "graspd/perception/preprocess.hpp"
#include "graspd/perception/segmentation.hpp"

namespace graspd::eval {
namespace {

std::vector<std::string> parts_in(const BopImage& image, const parts::Catalogue& catalogue) {
  std::vector<std::string> ids;
  for (const parts::Part& part : catalogue.parts()) {
    const bool present =
        image.truth.empty() ||
        std::any_of(image.truth.begin(), image.truth.end(),
                    [&](const BopTruth& truth) { return truth.obj_id == part.bop_obj_id; });
    if (present) ids.push_back(part.id);
  }
  return ids;
}

/// The same stages as the plan's, run once more for their intermediate results.
SegmentationAccuracy measure_segmentation(const BopImage& image, const PlanRequest& request,
                                          const parts::Catalogue& catalogue,
                                          const perception::Parameters& parameters) {
  std::vector<const parts::Part*> parts;
  double diameter_m = 0;
  for (const RequestedPart& requested : request.parts) {
    parts.push_back(catalogue.find(requested.id));
    diameter_m = std::max(diameter_m, parts.back()->diameter_m);
  }
  const perception::Scene scene =
      perception::prepare_scene(image.frame, request, diameter_m, parameters);
  const auto segments =
      perception::segment(scene.cloud, parts, parameters.preprocess, parameters.segmentation);
  return segmentation_accuracy(scene.cloud, segments, image);
}

}  // namespace

PlanRequest request_for(const BopImage& image, const parts::Catalogue& catalogue,
                        const std::vector<std::string>& part_ids) {
  return graspd::request_for(image, part_ids.empty() ? parts_in(image, catalogue) : part_ids);
}

Result<ImageReport> evaluate_image(const BopImage& image, int scene_id, const PlanRequest& request,
                                   const parts::Catalogue& catalogue,
                                   const perception::Parameters& parameters) {
  ImageReport report;
  report.im_id = image.im_id;
  const auto start = std::chrono::steady_clock::now();
  const std::clock_t cpu_start = std::clock();
  auto answer = perception::plan(image.frame, request, catalogue, parameters);
  if (!answer) return tl::unexpected(answer.error());
  report.time_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  report.cpu_time_s = static_cast<double>(std::clock() - cpu_start) / CLOCKS_PER_SEC;
  report.answer = *std::move(answer);
  for (const Object& object : report.answer.objects) {
    report.results.push_back({scene_id, image.im_id, catalogue.find(object.part_id)->bop_obj_id,
                              object.score, request.T_base_camera.inverse() * object.T_base_part,
                              report.time_s});
  }
  if (image.instance) {
    report.segmentation = measure_segmentation(image, request, catalogue, parameters);
  }
  if (!image.truth.empty()) report.poses = pose_accuracy(report.results, image, catalogue);
  return report;
}

}  // namespace graspd::eval
