#include "graspd/perception/pose_kernel.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <random>

#include "random_points.hpp"

namespace graspd::perception {
namespace {

using Eigen::Vector3f;

/// What the kernel is to compute, one point after the other.
PoseCounts count_by_hand(const PackedDepth& depth, const KernelPose& pose, const PointSpan& points,
                         float tolerance_m, const EarlyStop& stop) {
  PoseCounts counts;
  const float tolerance = tolerance_m / PackedDepth::kUnit_m;
  for (std::size_t i = 0; i < points.size; ++i) {
    const auto row = [&](int k) {
      return std::fma(
                 pose.R[3 * k], points.x_m[i],
                 std::fma(pose.R[3 * k + 1], points.y_m[i], pose.R[3 * k + 2] * points.z_m[i])) +
             pose.t_m[k];
    };
    const float inverse = 1.0F / row(2);
    const auto u =
        static_cast<int>(std::nearbyint(std::fma(row(0) * inverse, depth.fx_px, depth.cx_px)));
    const auto v =
        static_cast<int>(std::nearbyint(std::fma(row(1) * inverse, depth.fy_px, depth.cy_px)));
    ++counts.tested_n;
    if (u >= 0 && v >= 0 && u < depth.width_px && v < depth.height_px) {
      const std::uint32_t cell = depth.cells[v * depth.width_px + u];
      const float expected = row(2) * (1 / PackedDepth::kUnit_m);
      const float error = static_cast<float>(cell & 0xFFFFU) - expected;
      const float nearest_error = static_cast<float>(cell >> 16U) - expected;
      counts.refute_n += cell >> 16U != 0 && nearest_error > tolerance;
      if ((cell & 0xFFFFU) != 0) {
        counts.hidden_n += error < -tolerance;
        if (std::abs(error) <= tolerance) {
          ++counts.support_n;
          const auto whole = static_cast<std::int32_t>(std::nearbyint(error));
          counts.error2_sum += whole * whole;
        }
      }
    }
    if (i + 1 == 16 && points.size > 16 &&
        (counts.support_n < stop.min_support_n || counts.refute_n > stop.max_refute_n)) {
      break;
    }
  }
  return counts;
}

class PoseKernel : public ::testing::Test {
 protected:
  static constexpr int kWidth = 64, kHeight = 48;

  PoseKernel() {
    std::uniform_int_distribution<std::uint32_t> reading(6900, 7300);
    for (int v = 1; v < kHeight - 1; ++v) {
      for (int u = 1; u < kWidth - 1; ++u) {
        // Of floor and walls only the nearest reading is there.
        const std::uint32_t z = random_() % 10 == 0 ? 0 : reading(random_);
        const bool is_part = random_() % 5 != 0;
        const auto nearest = z == 0 ? 0 : z - static_cast<std::uint32_t>(random_() % 100);
        cells_[std::size_t(v * kWidth + u)] = (is_part ? z : 0) | nearest << 16U;
      }
    }
  }

  /// So many points with normals, and a pose that lays them about the image.
  void draw(std::size_t count) {
    for (auto* array : {&x_, &y_, &z_, &nx_, &ny_, &nz_}) array->assign(count + 16, 0);
    for (std::size_t i = 0; i < count; ++i) {
      const Vector3f p = testing::random_point(random_, 0.06F);
      const Vector3f n = testing::random_point(random_, 1).normalized();
      x_[i] = p.x(), y_[i] = p.y(), z_[i] = p.z() / 4;
      nx_[i] = n.x(), ny_[i] = n.y(), nz_[i] = n.z();
    }
    surface_ = {{x_.data(), y_.data(), z_.data(), count}, nx_.data(), ny_.data(), nz_.data()};
    const Eigen::Matrix3d R = testing::random_rotation(random_).toRotationMatrix();
    pose_ = {};
    for (int k = 0; k < 9; ++k) pose_.R[k] = static_cast<float>(R(k / 3, k % 3));
    pose_.t_m[2] = 0.71F;
  }

  std::mt19937 random_{11};
  std::vector<std::uint32_t> cells_ = std::vector<std::uint32_t>(std::size_t(kWidth * kHeight), 0);
  PackedDepth depth_{cells_.data(), kWidth, kHeight, 365, 365, 31, 23};
  std::vector<float> x_, y_, z_, nx_, ny_, nz_;
  SurfaceSpan surface_{};
  KernelPose pose_{};
};

TEST_F(PoseKernel, CountsAsOnePointAfterTheOther) {
  for (int round = 0; round < 300; ++round) {
    draw(1 + random_() % 90);
    const EarlyStop stop = round % 2 == 0 ? EarlyStop{} : EarlyStop{4, 4};
    const PoseCounts counts = count_evidence(depth_, pose_, surface_.points, 0.008F, stop);
    const PoseCounts expected = count_by_hand(depth_, pose_, surface_.points, 0.008F, stop);
    EXPECT_EQ(counts.tested_n, expected.tested_n);
    EXPECT_EQ(counts.support_n, expected.support_n);
    EXPECT_EQ(counts.refute_n, expected.refute_n);
    EXPECT_EQ(counts.hidden_n, expected.hidden_n);
    EXPECT_EQ(counts.error2_sum, expected.error2_sum);
  }
}

TEST_F(PoseKernel, IcpEquationsAreThoseOfTheSinglePoints) {
  constexpr double kTolerance_m = 0.008, kRadius_m = 0.04;
  const Eigen::Vector3d centre_m(0.01, -0.02, 0.70);
  int used_n = 0;
  for (int round = 0; round < 100; ++round) {
    draw(1 + random_() % 90);
    Eigen::Matrix<double, 6, 6> A = Eigen::Matrix<double, 6, 6>::Zero();
    Eigen::Matrix<double, 6, 1> b = Eigen::Matrix<double, 6, 1>::Zero();
    int points_n = 0;
    const Eigen::Matrix3d R =
        Eigen::Map<const Eigen::Matrix<float, 3, 3, Eigen::RowMajor>>(pose_.R).cast<double>();
    for (std::size_t i = 0; i < surface_.points.size; ++i) {
      const Eigen::Vector3d p =
          R * Eigen::Vector3d(x_[i], y_[i], z_[i]) + Eigen::Vector3d(0, 0, pose_.t_m[2]);
      const Eigen::Vector3d n = R * Eigen::Vector3d(nx_[i], ny_[i], nz_[i]);
      const int u = int(std::nearbyint(p.x() / p.z() * 365 + 31));
      const int v = int(std::nearbyint(p.y() / p.z() * 365 + 23));
      if (u < 0 || v < 0 || u >= kWidth || v >= kHeight) continue;
      const std::uint32_t reading = cells_[std::size_t(v * kWidth + u)] & 0xFFFFU;
      const double z_m = reading * double(PackedDepth::kUnit_m);
      if (reading == 0 || std::abs(z_m - p.z()) > kTolerance_m) continue;
      ++points_n;
      const double distance_m = n.dot(p * (z_m / p.z()) - p);
      const double root = std::max(0.0, 1 - std::pow(distance_m / kTolerance_m, 2));
      Eigen::Matrix<double, 6, 1> J;
      J << ((p - centre_m) / kRadius_m).cross(n), n;
      A += root * root * J * J.transpose();
      b += root * root * distance_m * J;
    }
    const NormalEquations found = icp_equations(
        depth_, pose_, surface_,
        {{float(centre_m.x()), float(centre_m.y()), float(centre_m.z())}, float(kRadius_m)},
        float(kTolerance_m));
    ASSERT_EQ(found.points_n, points_n);
    used_n += points_n;
    for (int row = 0, k = 0; row < 6; ++row) {
      for (int column = row; column < 6; ++column, ++k) {
        EXPECT_NEAR(found.A[k], A(row, column), 1e-3 * (1 + std::abs(A(row, column))));
      }
      EXPECT_NEAR(found.b[row], b[row], 1e-5 * (1 + std::abs(b[row])));
    }
  }
  EXPECT_GT(used_n, 100);
}

TEST_F(PoseKernel, WeighsSupportPointByPoint) {
  constexpr SupportWeights kWeights{0.008F, 4, 0.5F, 0.9F, 0.5F};
  std::vector<Vector3f> normals(cells_.size(), Vector3f::Zero());
  for (Vector3f& normal : normals) {
    if (random_() % 4 != 0) normal = testing::random_point(random_, 1).normalized();
  }
  float all = 0;
  for (int round = 0; round < 100; ++round) {
    draw(1 + random_() % 90);
    std::vector<std::int32_t> cells(surface_.points.size + 16);
    std::vector<float> z_m(cells.size());
    project_points(depth_, pose_, surface_.points, cells.data(), z_m.data());
    const Eigen::Matrix3f R =
        Eigen::Map<const Eigen::Matrix<float, 3, 3, Eigen::RowMajor>>(pose_.R);
    float expected = 0;
    for (std::size_t i = 0; i < surface_.points.size; ++i) {
      const Vector3f p = R * Vector3f(x_[i], y_[i], z_[i]) + Vector3f(0, 0, pose_.t_m[2]);
      EXPECT_NEAR(z_m[i], p.z(), 1e-6F);
      const auto u = static_cast<int>(std::nearbyint(p.x() / p.z() * 365 + 31));
      const auto v = static_cast<int>(std::nearbyint(p.y() / p.z() * 365 + 23));
      const bool is_inside = u > 0 && v > 0 && u < kWidth - 1 && v < kHeight - 1;
      ASSERT_EQ(cells[i], is_inside ? v * kWidth + u : 0);
      const auto cell = static_cast<std::size_t>(cells[i]);
      const std::uint32_t reading = cells_[cell] & 0xFFFFU;
      const float error = (float(reading) * PackedDepth::kUnit_m - p.z()) / kWeights.tolerance_m;
      if (reading == 0 || std::abs(error) > 1) continue;
      const float cosine = normals[cell].dot(R * Vector3f(nx_[i], ny_[i], nz_[i]));
      const float agreement =
          normals[cell].isZero() ? 1 : std::clamp((cosine - 0.5F) / 0.4F, 0.0F, 1.0F);
      const float closeness = (1 - error * error + std::max(0.0F, 1 - 4 * error * error)) / 2;
      expected += closeness * (1 - 0.5F * (1 - agreement));
    }
    EXPECT_NEAR(weigh_support(depth_, normals.front().data(), pose_, surface_, kWeights), expected,
                1e-3F);
    all += expected;
  }
  EXPECT_GT(all, 100);
}

}  // namespace
}  // namespace graspd::perception
