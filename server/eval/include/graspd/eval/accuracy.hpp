#pragma once

#include <map>
#include <span>
#include <vector>

#include "graspd/formats/bop.hpp"
#include "graspd/parts/catalogue.hpp"
#include "graspd/perception/cloud.hpp"

namespace graspd::eval {

/// How well segments agree with the instance ids of the image, by the points of the cloud.
struct SegmentationAccuracy {
  int objects_n = 0;         ///< visible by half or more
  int found_n = 0;           ///< of these: some segment has IoU ≥ 0.5 with it
  int over_segmented_n = 0;  ///< of these: two or more segments with a tenth of it lie mostly in it
  int under_segmented_n = 0;  ///< segments that hold a fifth or more of two or more objects
  int points_n = 0;           ///< of objects, whatever their visibility
  int points_kept_n = 0;      ///< of these: in a segment

  SegmentationAccuracy& operator+=(const SegmentationAccuracy& other);
  double accuracy() const { return objects_n == 0 ? 0 : double(found_n) / objects_n; }
  double kept() const { return points_n == 0 ? 0 : double(points_kept_n) / points_n; }
};

/// A point belongs to the instance at the pixel it projects to.
SegmentationAccuracy segmentation_accuracy(const perception::Cloud& cloud,
                                           std::span<const perception::Indices> segments,
                                           const BopImage& image);

/// How well posed parts agree with the true poses. A pose is right where its MSSD is below a tenth
/// of the diameter. Objects visible by less than half neither help nor hurt (Brégier 2017).
struct PoseAccuracy {
  int objects_n = 0;  ///< visible by half or more
  int found_n = 0;
  int answers_n = 0;  ///< without those that hit a less visible object
  int right_n = 0;

  PoseAccuracy& operator+=(const PoseAccuracy& other);
  double recall() const { return objects_n == 0 ? 0 : double(found_n) / objects_n; }
  double precision() const { return answers_n == 0 ? 0 : double(right_n) / answers_n; }
};

/// \param results of this image, matched best score first, each true object once.
PoseAccuracy pose_accuracy(std::span<const BopResult> results, const BopImage& image,
                           const parts::Catalogue& catalogue);

}  // namespace graspd::eval
