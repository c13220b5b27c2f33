#pragma once

#include <span>
#include <vector>

#include "graspd/parts/part.hpp"
#include "graspd/perception/cloud.hpp"
#include "graspd/perception/parameters.hpp"

namespace graspd::perception {

/// A segmentation method: a cloud with normals in, disjoint clusters of its points out, in a fixed
/// order, whatever their size. The comparators are PCL's own classes.
using SegmentationMethod = std::vector<Indices> (*)(const Cloud&, const SegmentationParameters&);

/// The paper's Algorithm 1, on the image grid; on the octree where the cloud is not organised.
std::vector<Indices> grid_dbscan(const Cloud& cloud, const SegmentationParameters& parameters);
/// The paper's Algorithm 1, on an octree.
std::vector<Indices> improved_dbscan(const Cloud& cloud, const SegmentationParameters& parameters);
/// Plain DBSCAN on PCL's kd-tree.
std::vector<Indices> plain_dbscan(const Cloud& cloud, const SegmentationParameters& parameters);
/// Points nearer than `euclidean_tolerance_m` belong together.
std::vector<Indices> euclidean_clusters(const Cloud& cloud,
                                        const SegmentationParameters& parameters);
/// Rabbani et al. 2006: neighbours whose normals differ by little, from the flattest point on.
std::vector<Indices> region_growing(const Cloud& cloud, const SegmentationParameters& parameters);

/// \throws std::invalid_argument for kServerDefault, which the caller resolves.
SegmentationMethod segmentation_method(Segmentation name);

/// The named method, without the segments that are too small to be one of the parts: those with
/// less than `min_segment_share` of the points that the smallest part shows when nothing hides it.
std::vector<Indices> segment(const Cloud& cloud, std::span<const parts::Part* const> parts,
                             const PreprocessParameters& preprocess,
                             const SegmentationParameters& parameters);

/// Of a segment that is not empty, in the camera's optical frame.
Eigen::Vector3d centroid_m(const Cloud& cloud, const Indices& segment);

}  // namespace graspd::perception
