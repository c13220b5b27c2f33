#include "graspd/eval/segmentation_accuracy.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <vector>

#include "graspd/eval/visibility.hpp"
#include "graspd/types/camera_model.hpp"

namespace graspd::eval {
namespace {

constexpr double kMinIou = 0.5;
constexpr double kMergedShare = 0.2;  // of an object, for a segment to count as holding it
constexpr double kPieceShare = 0.1;   // of an object, for a segment to count as a piece of it
constexpr int kNoSegment = -1;

/// Instance ids by point; 0 for the background.
std::vector<int> instance_of_points(const perception::Cloud& cloud, const BopImage& image) {
  std::vector<int> ids;
  for (const auto& p : cloud.points_m) {
    const Eigen::Vector2d pixel = project(image.frame.camera, p.cast<double>());
    const auto u = static_cast<int>(std::lround(pixel.x()));
    const auto v = static_cast<int>(std::lround(pixel.y()));
    const bool inside =
        u >= 0 && v >= 0 && u < image.frame.camera.width_px && v < image.frame.camera.height_px;
    ids.push_back(
        inside
            ? image.instance->values[static_cast<std::size_t>(v) * image.frame.camera.width_px + u]
            : 0);
  }
  return ids;
}

/// Visible by half or more, or, where the data set does not say, labelled at all.
std::vector<int> counted_instances(const std::map<int, int>& points_of, const BopImage& image) {
  std::vector<int> counted;
  for (const auto& [id, count] : points_of) {
    const bool known = id >= 1 && id <= static_cast<int>(image.truth.size());
    if (!known || image.truth[id - 1].visible_fraction >= kMinVisible) counted.push_back(id);
  }
  return counted;
}

}  // namespace

SegmentationAccuracy& SegmentationAccuracy::operator+=(const SegmentationAccuracy& other) {
  objects_n += other.objects_n;
  found_n += other.found_n;
  over_segmented_n += other.over_segmented_n;
  under_segmented_n += other.under_segmented_n;
  points_n += other.points_n;
  points_kept_n += other.points_kept_n;
  return *this;
}

SegmentationAccuracy segmentation_accuracy(const perception::Cloud& cloud,
                                           std::span<const perception::Indices> segments,
                                           const BopImage& image) {
  const std::vector<int> ids = instance_of_points(cloud, image);
  std::vector<int> segment_of(cloud.size(), kNoSegment);
  for (std::size_t s = 0; s < segments.size(); ++s) {
    for (const std::uint32_t i : segments[s]) segment_of[i] = static_cast<int>(s);
  }
  SegmentationAccuracy accuracy;
  std::map<int, int> points_of;
  std::map<std::pair<int, int>, int> common;  // (object, segment)
  for (std::size_t i = 0; i < ids.size(); ++i) {
    if (ids[i] == 0) continue;
    ++points_of[ids[i]];
    ++accuracy.points_n;
    if (segment_of[i] == kNoSegment) continue;
    ++accuracy.points_kept_n;
    ++common[{ids[i], segment_of[i]}];
  }
  std::map<int, int> objects_in_segment;
  for (const int id : counted_instances(points_of, image)) {
    ++accuracy.objects_n;
    bool found = false;
    int segments_inside = 0;
    for (auto entry = common.lower_bound({id, 0});
         entry != common.end() && entry->first.first == id; ++entry) {
      const auto& [key, count] = *entry;
      const auto segment_size = static_cast<int>(segments[key.second].size());
      const double iou = double(count) / (points_of[id] + segment_size - count);
      found |= iou >= kMinIou;
      segments_inside += 2 * count > segment_size && count >= kPieceShare * points_of[id];
      if (count >= kMergedShare * points_of[id]) ++objects_in_segment[key.second];
    }
    accuracy.found_n += found;
    accuracy.over_segmented_n += segments_inside >= 2;
  }
  accuracy.under_segmented_n =
      static_cast<int>(std::count_if(objects_in_segment.begin(), objects_in_segment.end(),
                                     [](const auto& entry) { return entry.second >= 2; }));
  return accuracy;
}

}  // namespace graspd::eval
