#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "graspd/types/frame.hpp"

/// The calibration board: ChArUco, a chessboard with markers in its white squares, so that it may
/// be seen in part and upside down.
namespace graspd::calibration {

/// As it was printed.
struct Board {
  int columns_n = 0;  ///< of squares
  int rows_n = 0;
  double square_m = 0;
  double marker_m = 0;
  std::string dictionary = "DICT_4X4_50";  ///< one of ArUco's own
  /// The plate goes on, plain, for this much around the pattern.
  double margin_m = 0;

  Eigen::Vector2d size_m() const { return {columns_n * square_m, rows_n * square_m}; }
};

/// 8 bits a pixel.
struct GrayImage {
  int width_px = 0;
  int height_px = 0;
  std::vector<std::uint8_t> values;  ///< row by row
};

/// Infrared images have 16 bits, of which few are used: their brightest percent becomes white.
/// \param is_mirrored swaps left and right.
Result<GrayImage> read_gray_image(const std::filesystem::path& path, bool is_mirrored);

/// The board as one image shows it. Its frame: origin at the pattern's upper left corner, x to the
/// right, y down, z into the board.
struct BoardView {
  std::vector<Eigen::Vector3d> p_board_m;  ///< chessboard corners
  std::vector<Eigen::Vector2d> p_px;       ///< where they are seen
  Eigen::Isometry3d T_camera_board = Eigen::Isometry3d::Identity();
  double rms_px = 0;  ///< of the corners' reprojection
};

/// Sets the view's pose and `rms_px` from its corners; at least four, not in a line.
void find_pose(BoardView& view, const CameraIntrinsics& camera);

/// \returns INVALID_ARGUMENT where the board is not as described (names, sizes), is not seen or
/// only in part, is seen mirrored, or where its corners do not fit it.
Result<BoardView> find_board(const GrayImage& image, const Board& board,
                             const CameraIntrinsics& camera);

}  // namespace graspd::calibration
