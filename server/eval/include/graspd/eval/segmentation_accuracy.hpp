#pragma once

#include <span>

#include "graspd/formats/bop.hpp"
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

}  // namespace graspd::eval
