#include "board_scene.hpp"

#include <cmath>
#include <opencv2/aruco/charuco.hpp>
#include <random>

#include "graspd/types/camera_model.hpp"

namespace graspd::testing {
namespace {

constexpr int kSquare_px = 80;  ///< of the drawn pattern
constexpr int kRays = 3;        ///< along each side of a pixel

cv::Mat draw_pattern(const calibration::Board& board) {
  const auto charuco = cv::aruco::CharucoBoard::create(
      board.columns_n, board.rows_n, static_cast<float>(board.square_m),
      static_cast<float>(board.marker_m),
      cv::aruco::getPredefinedDictionary(cv::aruco::DICT_4X4_50));
  cv::Mat pattern;
  charuco->draw({board.columns_n * kSquare_px, board.rows_n * kSquare_px}, pattern, 0, 1);
  return pattern;
}

/// Where a ray meets the board's plane: in the board's frame, and its depth.
struct Hit {
  Eigen::Vector3d p_board_m;
  double z_m;
};

class Plane {
 public:
  explicit Plane(const Eigen::Isometry3d& T_camera_board)
      : T_board_camera_(T_camera_board.inverse()),
        normal_(T_camera_board.linear().col(2)),
        distance_m_(normal_.dot(T_camera_board.translation())) {}
  Hit meet(const Eigen::Vector3d& ray) const {
    const double z_m = distance_m_ / normal_.dot(ray);
    return {T_board_camera_ * (z_m * ray), z_m};
  }

 private:
  Eigen::Isometry3d T_board_camera_;
  Eigen::Vector3d normal_;
  double distance_m_;
};

bool is_on_plate(const Eigen::Vector3d& p_board_m, const calibration::Board& board) {
  const Eigen::Array2d p = p_board_m.head<2>().array();
  return (p >= -board.margin_m).all() && (p <= board.size_m().array() + board.margin_m).all();
}

double grey_at(const cv::Mat& pattern, const Eigen::Vector3d& p_board_m,
               const calibration::Board& board) {
  constexpr double kPlate = 190;
  constexpr double kBackground = 90;
  if (!is_on_plate(p_board_m, board)) return kBackground;
  const double column = p_board_m.x() / board.square_m * kSquare_px;
  const double row = p_board_m.y() / board.square_m * kSquare_px;
  const bool is_print = column >= 0 && row >= 0 && column < pattern.cols && row < pattern.rows;
  if (!is_print) return kPlate;
  const auto print = pattern.at<std::uint8_t>(static_cast<int>(row), static_cast<int>(column));
  return 30 + print / 255.0 * 160;
}

}  // namespace

Eigen::Isometry3d facing(const calibration::Board& board, const Eigen::Vector2d& aside_m,
                         double distance_m, const Eigen::Vector3d& turn_rad) {
  using Eigen::AngleAxisd;
  using Eigen::Vector3d;
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  T.translation() << aside_m, distance_m;
  T.rotate(AngleAxisd(turn_rad.x(), Vector3d::UnitX()) *
           AngleAxisd(turn_rad.y(), Vector3d::UnitY()) *
           AngleAxisd(turn_rad.z(), Vector3d::UnitZ()));
  T.translate(Vector3d(-board.size_m().x() / 2, -board.size_m().y() / 2, 0));
  return T;
}

calibration::GrayImage see_board(const BoardScene& scene, double noise, std::uint64_t seed) {
  const cv::Mat pattern = draw_pattern(scene.board);
  const Plane plane(scene.T_camera_board);
  std::mt19937_64 random(seed);
  std::normal_distribution<double> gaussian(0, noise);
  calibration::GrayImage image{scene.camera.width_px, scene.camera.height_px, {}};
  for (int v = 0; v < image.height_px; ++v) {
    for (int u = 0; u < image.width_px; ++u) {
      const Eigen::Vector3d ray = ray_through(scene.camera, u, v);
      const Eigen::Vector3d right = ray_through(scene.camera, u + 0.5, v) - ray;
      const Eigen::Vector3d down = ray_through(scene.camera, u, v + 0.5) - ray;
      double sum = 0;
      for (int i = 0; i < kRays * kRays; ++i) {
        const int column = i % kRays;
        const int row = i / kRays;
        const double a = (2.0 * column + 1) / kRays - 1;
        const double b = (2.0 * row + 1) / kRays - 1;
        sum += grey_at(pattern, plane.meet(ray + a * right + b * down).p_board_m, scene.board);
      }
      const double grey = sum / (kRays * kRays) + gaussian(random);
      image.values.push_back(static_cast<std::uint8_t>(std::clamp(std::round(grey), 0.0, 255.0)));
    }
  }
  return image;
}

DepthFrame read_plate(const BoardScene& scene, double noise_m, std::uint64_t seed,
                      const std::function<double(const Eigen::Vector3d&, double)>& off_m) {
  const Plane plane(scene.T_camera_board);
  std::mt19937_64 random(seed);
  std::normal_distribution<double> gaussian(0, noise_m);
  DepthFrame frame{scene.camera, 0.001, {}};
  for (int v = 0; v < scene.camera.height_px; ++v) {
    for (int u = 0; u < scene.camera.width_px; ++u) {
      const Eigen::Vector3d ray = ray_through(scene.camera, u, v);
      const Hit hit = plane.meet(ray);
      const double z_m = hit.z_m + off_m(ray, hit.z_m) + gaussian(random);
      const bool is_read = is_on_plate(hit.p_board_m, scene.board);
      frame.depth.push_back(is_read ? static_cast<std::uint16_t>(std::round(z_m * 1e3)) : 0);
    }
  }
  return frame;
}

}  // namespace graspd::testing
