#include "golden_frame.hpp"

#include <algorithm>
#include <cmath>

namespace graspd::program {
namespace {

constexpr int kWidth_px = 160;
constexpr int kHeight_px = 128;
constexpr double kDiameter_px = 50;  ///< of the part, as tees have in a Kinect v2's frames
// Of the diameter: how far off the part's middle may be found, and the edge of the crop box.
constexpr double kTolerance = 0.25;
constexpr double kBox = 2.4;

/// The part's pose in base, which is on the floor below the camera: broad side down, and turned, so
/// that no edge runs along the image's rows.
Eigen::Isometry3d lying(const parts::Part& part) {
  Eigen::Isometry3d T_base_part = Eigen::Isometry3d::Identity();
  T_base_part.linear() = Eigen::AngleAxisd(0.4, Eigen::Vector3d::UnitZ()).toRotationMatrix() *
                         part.principal_axes.transpose();
  double lowest_m = 0;
  for (const Eigen::Vector3f& vertex : part.mesh.vertices_m) {
    const Eigen::Vector3d p = T_base_part.linear() * (vertex.cast<double>() - part.barycentre_m);
    lowest_m = std::min(lowest_m, p.z());
  }
  T_base_part.translation() =
      Eigen::Vector3d(0, 0, -lowest_m) - T_base_part.linear() * part.barycentre_m;
  return T_base_part;
}

/// So that the part is as many pixels wide as any other.
CameraIntrinsics camera_for(double diameter_m, double height_m) {
  const double focal_px = kDiameter_px / diameter_m * height_m;
  return {kWidth_px, kHeight_px, focal_px, focal_px, (kWidth_px - 1) / 2.0, (kHeight_px - 1) / 2.0,
          {}};
}

/// What stands where a pixel looks: the z-buffer of a triangle mesh, in metres.
class DepthBuffer {
 public:
  DepthBuffer(const CameraIntrinsics& camera, double floor_z_m)
      : camera_(camera),
        z_m_(static_cast<std::size_t>(camera.width_px) * static_cast<std::size_t>(camera.height_px),
             floor_z_m) {}

  /// \param corners in the camera's frame
  void draw(const std::array<Eigen::Vector3d, 3>& corners) {
    // Rows: u, v and inverse depth, which is linear in u and v.
    Eigen::Matrix3d image;
    for (int i = 0; i < 3; ++i) {
      const Eigen::Vector3d& p = corners[static_cast<std::size_t>(i)];
      image.col(i) << camera_.fx_px * p.x() / p.z() + camera_.cx_px,
          camera_.fy_px * p.y() / p.z() + camera_.cy_px, 1 / p.z();
    }
    Eigen::Matrix3d weights = image;
    weights.row(2).setOnes();
    if (std::abs(weights.determinant()) < 1e-9) return;  // seen edge on
    weights = weights.inverse().eval();
    const auto first = [](double low) { return std::max(0, static_cast<int>(std::ceil(low))); };
    const auto last = [](double high, int n) {
      return std::min(n - 1, static_cast<int>(std::floor(high)));
    };
    for (int v = first(image.row(1).minCoeff());
         v <= last(image.row(1).maxCoeff(), camera_.height_px); ++v) {
      for (int u = first(image.row(0).minCoeff());
           u <= last(image.row(0).maxCoeff(), camera_.width_px); ++u) {
        const Eigen::Vector3d share = weights * Eigen::Vector3d(u, v, 1);
        if (share.minCoeff() < 0) continue;
        double& z_m = at(u, v);
        z_m = std::min(z_m, 1 / image.row(2).dot(share));
      }
    }
  }

  std::vector<std::uint16_t> readings(double depth_scale_m) const {
    std::vector<std::uint16_t> depth;
    for (const double z_m : z_m_) {
      depth.push_back(static_cast<std::uint16_t>(std::lround(z_m / depth_scale_m)));
    }
    return depth;
  }

 private:
  double& at(int u, int v) {
    return z_m_[static_cast<std::size_t>(v) * static_cast<std::size_t>(camera_.width_px) +
                static_cast<std::size_t>(u)];
  }

  CameraIntrinsics camera_;
  std::vector<double> z_m_;
};

DepthFrame render(const parts::Part& part, const Eigen::Isometry3d& T_camera_part,
                  const CameraIntrinsics& camera, double floor_z_m) {
  DepthBuffer buffer(camera, floor_z_m);
  for (const auto& triangle : part.mesh.triangles) {
    std::array<Eigen::Vector3d, 3> corners;
    for (std::size_t i = 0; i < 3; ++i) {
      const auto vertex = static_cast<std::size_t>(triangle[i]);
      corners[i] = T_camera_part * part.mesh.vertices_m[vertex].cast<double>();
    }
    buffer.draw(corners);
  }
  DepthFrame frame;
  frame.camera = camera;
  // Of a reading's 65535 steps, so that the floor is within them however far it is.
  frame.depth_scale_m = std::max(0.0005, floor_z_m / 60'000);
  frame.depth = buffer.readings(frame.depth_scale_m);
  return frame;
}

Result<void> check(const PlanAnswer& answer, const std::string& part_id,
                   const Eigen::Vector3d& barycentre_m, const Eigen::Vector3d& p_base_m,
                   double tolerance_m) {
  double nearest_m = INFINITY;
  for (const Object& object : answer.objects) {
    if (object.part_id != part_id) continue;
    nearest_m = std::min(nearest_m, (object.T_base_part * barycentre_m - p_base_m).norm());
  }
  if (nearest_m <= tolerance_m) return {};
  const std::string found =
      std::isfinite(nearest_m)
          ? fmt::format("was found {:.1f} mm from where it lies", nearest_m * 1000)
          : fmt::format("was not found ({}{}{})", name_of(answer.outcome),
                        answer.reason.empty() ? "" : ": ", answer.reason);
  return fail(
      Code::kInternal,
      "part '{}', alone on a floor, {}; check its mesh and unit, and the perception section "
      "of the configuration",
      part_id, found);
}

}  // namespace

service::GoldenFrame make_golden_frame(const parts::Part& part,
                                       const perception::Parameters& parameters) {
  const perception::PreprocessParameters& depths = parameters.preprocess;
  const double floor_z_m =
      std::clamp(std::max(0.75, 4 * part.diameter_m), 1.1 * depths.min_depth_m + part.diameter_m,
                 std::max(0.9 * depths.max_depth_m, 1.1 * depths.min_depth_m + part.diameter_m));
  Eigen::Isometry3d T_base_camera = Eigen::Isometry3d::Identity();
  T_base_camera.linear() = Eigen::Vector3d(1, -1, -1).asDiagonal();
  T_base_camera.translation().z() = floor_z_m;
  const Eigen::Isometry3d T_base_part = lying(part);

  service::GoldenFrame golden;
  golden.frame = render(part, T_base_camera.inverse() * T_base_part,
                        camera_for(part.diameter_m, floor_z_m), floor_z_m);
  golden.request.T_base_camera = T_base_camera;
  golden.request.crop_box =
      CropBox{Eigen::Isometry3d::Identity(), Eigen::Vector3d::Constant(kBox * part.diameter_m)};
  golden.request.parts = {{part.id, 0}};
  golden.check = [id = part.id, barycentre_m = part.barycentre_m,
                  p_base_m = Eigen::Vector3d(T_base_part * part.barycentre_m),
                  tolerance_m = kTolerance * part.diameter_m](const PlanAnswer& answer) {
    return check(answer, id, barycentre_m, p_base_m, tolerance_m);
  };
  return golden;
}

}  // namespace graspd::program
