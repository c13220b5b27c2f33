#include "graspd/perception/plane_fit.hpp"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <random>

namespace graspd::perception {
namespace {

using Eigen::Vector3f;

// No whole number of vectors wide.
constexpr PixelGrid kImage{43, 31, 365, 360, 20, 15};
constexpr int kReach_px = 3;

struct Fitted {
  std::vector<Vector3f> normals;
  std::vector<float> curvatures;

  explicit Fitted(const std::vector<float>& z_m) { fit_planes(z_m, kImage, normals, curvatures); }
};

std::size_t cell(int u, int v) { return static_cast<std::size_t>(v * kImage.width_px + u); }

Vector3f ray(int u, int v) {
  return {(static_cast<float>(u) - kImage.cx_px) / kImage.fx_px,
          (static_cast<float>(v) - kImage.cy_px) / kImage.fy_px, 1};
}

/// Depths of a plane through (0, 0, 0.7) seen along each pixel's ray.
std::vector<float> plane_seen(const Vector3f& normal) {
  std::vector<float> z_m;
  for (int v = 0; v < kImage.height_px; ++v) {
    for (int u = 0; u < kImage.width_px; ++u) {
      z_m.push_back(normal.z() * 0.7F / normal.dot(ray(u, v)));
    }
  }
  return z_m;
}

TEST(FitPlanes, FindsAPlaneFromWhateverSide) {
  for (const Vector3f& towards :
       {Vector3f(0, 0, -1), Vector3f(0.6F, 0, -1), Vector3f(-0.3F, 0.8F, -1)}) {
    const Vector3f normal = towards.normalized();
    const Fitted fitted(plane_seen(normal));
    for (std::size_t i = 0; i < fitted.normals.size(); ++i) {
      EXPECT_GT(fitted.normals[i].dot(normal), std::cos(0.01F)) << i;
      EXPECT_LT(fitted.curvatures[i], 1e-4F);
    }
  }
}

TEST(FitPlanes, IsLeastSquaresOverTheSameSurface) {
  std::mt19937 random(4);
  std::normal_distribution<float> noise_m(0, 0.002F);
  std::vector<float> z_m = plane_seen(Vector3f(0.3F, -0.2F, -1).normalized());
  for (std::size_t i = 0; i < z_m.size(); ++i) {
    z_m[i] += noise_m(random) + (i % 43 > 25 ? 0.03F : 0);
    if (random() % 6 == 0) z_m[i] = 0;
  }
  const Fitted fitted(z_m);
  int compared_n = 0;
  for (int v = 0; v < kImage.height_px; ++v) {
    for (int u = 0; u < kImage.width_px; ++u) {
      const float here_m = z_m[cell(u, v)];
      std::vector<Vector3f> rows;
      std::vector<float> depths_m;
      for (int y = std::max(0, v - kReach_px); y <= std::min(kImage.height_px - 1, v + kReach_px);
           ++y) {
        for (int x = std::max(0, u - kReach_px); x <= std::min(kImage.width_px - 1, u + kReach_px);
             ++x) {
          const float there_m = z_m[cell(x, y)];
          if (there_m <= 0 || std::abs(there_m - here_m) > 0.008F) continue;
          rows.emplace_back(static_cast<float>(x), static_cast<float>(y), 1.0F);
          depths_m.push_back(there_m);
        }
      }
      const Vector3f& normal = fitted.normals[cell(u, v)];
      if (here_m == 0 || rows.size() < 12) {
        EXPECT_TRUE(normal.isZero());
        EXPECT_EQ(fitted.curvatures[cell(u, v)], 0);
        continue;
      }
      Eigen::MatrixX3d A(rows.size(), 3);
      Eigen::VectorXd b(rows.size());
      for (std::size_t k = 0; k < rows.size(); ++k) {
        A.row(static_cast<Eigen::Index>(k)) = rows[k].cast<double>();
        b[static_cast<Eigen::Index>(k)] = static_cast<double>(depths_m[k]);
      }
      const Vector3f fit = A.colPivHouseholderQr().solve(b).cast<float>();
      // Two more points of the fitted plane, a pixel away in depth per pixel.
      const float gx = fit.x() * kImage.fx_px / here_m, gy = fit.y() * kImage.fy_px / here_m;
      const Vector3f r = ray(u, v);
      const Vector3f expected = Vector3f(gx, gy, -1 - gx * r.x() - gy * r.y()).normalized();
      EXPECT_LT((normal - expected).norm(), 2e-3F) << u << ", " << v;
      ++compared_n;
    }
  }
  EXPECT_GT(compared_n, 900);
}

TEST(FitPlanes, CurvatureIsHighOnARidge) {
  std::vector<float> z_m;
  for (int v = 0; v < kImage.height_px; ++v) {
    for (int u = 0; u < kImage.width_px; ++u) {
      z_m.push_back(0.7F + 0.002F * static_cast<float>(std::abs(u - 20)));
    }
  }
  const Fitted fitted(z_m);
  EXPECT_GT(fitted.curvatures[cell(20, 15)], 10 * fitted.curvatures[cell(30, 15)]);
  EXPECT_GT(fitted.curvatures[cell(20, 15)], 0.03F);
  for (const float curvature : fitted.curvatures) EXPECT_LE(curvature, 1.0F / 3);
}

TEST(FitPlanes, AStepDoesNotTiltTheSurfacesBesideIt) {
  std::vector<float> z_m;
  for (std::size_t i = 0; i < cell(0, kImage.height_px); ++i) {
    z_m.push_back(i % 43 < 20 ? 0.65F : 0.7F);
  }
  for (const Vector3f& normal : Fitted(z_m).normals) EXPECT_LT(normal.z(), -std::cos(0.02F));
}

}  // namespace
}  // namespace graspd::perception
