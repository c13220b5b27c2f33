#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "graspd/eval/pose_accuracy.hpp"
#include "graspd/eval/segmentation_accuracy.hpp"
#include "graspd/perception/parameters.hpp"
#include "graspd/types/answer.hpp"

namespace graspd::eval {

/// One image: what was answered, and how true it is.
struct ImageReport {
  int im_id = 0;
  PlanAnswer answer;
  double time_s = 0;      ///< of the whole plan, loading excluded
  double cpu_time_s = 0;  ///< the same, of the processor, all threads of this process together
  std::vector<BopResult> results;
  std::optional<SegmentationAccuracy> segmentation;  ///< where instance ids are there
  std::optional<PoseAccuracy> poses;                 ///< where true poses are there
};

/// As graspd::request_for of the image.
/// \param part_ids which parts to look for; where empty, those in the image's ground truth, or the
/// whole catalogue without one.
PlanRequest request_for(const BopImage& image, const parts::Catalogue& catalogue,
                        const std::vector<std::string>& part_ids);

/// Plans one image and compares with what the data set knows of it.
Result<ImageReport> evaluate_image(const BopImage& image, int scene_id, const PlanRequest& request,
                                   const parts::Catalogue& catalogue,
                                   const perception::Parameters& parameters);

}  // namespace graspd::eval
