#pragma once

#include <gtest/gtest.h>
#include <unistd.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <filesystem>
#include <fstream>
#include <string>
#include <string_view>
#include <vector>

#include "graspd/parts/mesh.hpp"

/// Meshes with known properties, and files to load.
namespace graspd::parts {

/// A folder of this test alone, removed with it.
class TestFolder {
 public:
  TestFolder() {
    const auto* test = ::testing::UnitTest::GetInstance()->current_test_info();
    path_ = std::filesystem::temp_directory_path() /
            fmt::format("graspd_{}_{}_{}", test->test_suite_name(), test->name(), ::getpid());
    std::filesystem::create_directories(path_);
  }
  ~TestFolder() { std::filesystem::remove_all(path_); }
  TestFolder(const TestFolder&) = delete;
  TestFolder& operator=(const TestFolder&) = delete;

  std::filesystem::path write(const std::string& name, std::string_view content) const {
    const auto file = path_ / name;
    std::filesystem::create_directories(file.parent_path());
    std::ofstream(file, std::ios::binary) << content;
    return file;
  }
  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

/// Axis-aligned, with every side cut into `cuts_n` strips, so that triangles are of equal size.
inline Mesh box_mesh(const Eigen::Vector3f& min_m, const Eigen::Vector3f& size_m, int cuts_n = 1) {
  Mesh mesh;
  const auto index_of = [&](const Eigen::Vector3f& unit) {
    const Eigen::Vector3f p = min_m + unit.cwiseProduct(size_m);
    for (std::size_t i = 0; i < mesh.vertices_m.size(); ++i) {
      if (mesh.vertices_m[i] == p) return static_cast<int>(i);
    }
    mesh.vertices_m.push_back(p);
    return static_cast<int>(mesh.vertices_m.size()) - 1;
  };
  for (int axis = 0; axis < 3; ++axis) {
    for (const bool far_side : {false, true}) {
      for (int i = 0; i < cuts_n; ++i) {
        for (int j = 0; j < cuts_n; ++j) {
          const auto corner = [&](int di, int dj) {
            Eigen::Vector3f unit;
            unit[axis] = far_side ? 1.0F : 0.0F;
            unit[(axis + 1) % 3] = static_cast<float>(i + di) / static_cast<float>(cuts_n);
            unit[(axis + 2) % 3] = static_cast<float>(j + dj) / static_cast<float>(cuts_n);
            return index_of(unit);
          };
          const int a = corner(0, 0);
          const int b = corner(1, 0);
          const int c = corner(1, 1);
          const int d = corner(0, 1);
          if (far_side) {
            mesh.triangles.insert(mesh.triangles.end(), {{a, b, c}, {a, c, d}});
          } else {
            mesh.triangles.insert(mesh.triangles.end(), {{a, c, b}, {a, d, c}});
          }
        }
      }
    }
  }
  return mesh;
}

/// Two meshes as one list of triangles, vertices not merged.
inline Mesh joined(const Mesh& a, const Mesh& b) {
  Mesh both = a;
  const int offset = static_cast<int>(a.vertices_m.size());
  both.vertices_m.insert(both.vertices_m.end(), b.vertices_m.begin(), b.vertices_m.end());
  for (const auto& t : b.triangles) {
    both.triangles.push_back({t[0] + offset, t[1] + offset, t[2] + offset});
  }
  return both;
}

inline Mesh scaled(Mesh mesh, float factor) {
  for (auto& vertex : mesh.vertices_m) vertex *= factor;
  return mesh;
}

inline Mesh moved(Mesh mesh, const Eigen::Isometry3d& T) {
  for (auto& vertex : mesh.vertices_m) vertex = (T * vertex.cast<double>()).cast<float>();
  return mesh;
}

/// ASCII STL, where each triangle has vertices of its own.
inline std::string to_stl(const Mesh& mesh, double units_per_m) {
  std::string text = "solid test\n";
  for (const auto& triangle : mesh.triangles) {
    text += "facet normal 0 0 0\nouter loop\n";
    for (const int index : triangle) {
      const Eigen::Vector3f p =
          mesh.vertices_m[static_cast<std::size_t>(index)] * static_cast<float>(units_per_m);
      text += fmt::format("vertex {} {} {}\n", p.x(), p.y(), p.z());
    }
    text += "endloop\nendfacet\n";
  }
  return text + "endsolid test\n";
}

/// The property itself: every product is an element, and no two elements are the same.
inline void expect_group(std::vector<Eigen::Isometry3d> group, double tolerance) {
  group.push_back(Eigen::Isometry3d::Identity());
  for (const auto& a : group) {
    for (const auto& b : group) {
      const auto same_n = std::count_if(group.begin(), group.end(), [&](const auto& element) {
        return (element.matrix() - (a * b).matrix()).cwiseAbs().maxCoeff() < tolerance;
      });
      EXPECT_EQ(same_n, 1);
    }
  }
}

inline std::filesystem::path own_parts_folder() {
  return std::filesystem::path(GRASPD_SOURCE_DIR) / "deploy" / "parts";
}

}  // namespace graspd::parts
