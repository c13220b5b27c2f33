#pragma once

#include <pcl/point_cloud.h>
#include <pcl/point_types.h>

#include "graspd/perception/cloud.hpp"

/// The one place where our clouds become PCL's.
namespace graspd::perception {

inline pcl::PointCloud<pcl::PointXYZ>::Ptr to_pcl(const Cloud& cloud) {
  pcl::PointCloud<pcl::PointXYZ>::Ptr points(new pcl::PointCloud<pcl::PointXYZ>);
  points->reserve(cloud.size());
  for (const auto& p : cloud.points_m) points->emplace_back(p.x(), p.y(), p.z());
  return points;
}

inline pcl::PointCloud<pcl::Normal>::Ptr normals_to_pcl(const Cloud& cloud) {
  pcl::PointCloud<pcl::Normal>::Ptr normals(new pcl::PointCloud<pcl::Normal>);
  normals->reserve(cloud.size());
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    const auto& n = cloud.normals[i];
    normals->emplace_back(n.x(), n.y(), n.z(), cloud.curvatures[i]);
  }
  return normals;
}

}  // namespace graspd::perception
