#include "graspd/calibration/board.hpp"

#include <fmt/ranges.h>

#include <map>
#include <opencv2/aruco/charuco.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "opencv_types.hpp"

namespace graspd::calibration {
namespace {

constexpr int kMinCorners = 6;
/// Corners of the described board fit to a few tenths of a pixel; of another, to whole pixels.
constexpr double kMaxRms_px = 1.0;
/// A Kinect v2's markers have 2 to 3 pixels per bit: on twice the size they are found better.
constexpr int kEnlarged = 2;

const std::map<std::string, int>& dictionaries() {
  static const std::map<std::string, int> known = {
      {"DICT_4X4_50", cv::aruco::DICT_4X4_50},   {"DICT_4X4_100", cv::aruco::DICT_4X4_100},
      {"DICT_4X4_250", cv::aruco::DICT_4X4_250}, {"DICT_5X5_50", cv::aruco::DICT_5X5_50},
      {"DICT_5X5_100", cv::aruco::DICT_5X5_100}, {"DICT_5X5_250", cv::aruco::DICT_5X5_250},
      {"DICT_6X6_50", cv::aruco::DICT_6X6_50},   {"DICT_6X6_100", cv::aruco::DICT_6X6_100},
      {"DICT_6X6_250", cv::aruco::DICT_6X6_250}};
  return known;
}

Result<cv::Ptr<cv::aruco::CharucoBoard>> make_charuco(const Board& board) {
  const auto found = dictionaries().find(board.dictionary);
  if (found == dictionaries().end()) {
    std::vector<std::string> names;
    for (const auto& [name, id] : dictionaries()) names.push_back(name);
    return invalid("there is no dictionary '{}'; known: {}", board.dictionary,
                   fmt::join(names, ", "));
  }
  if (board.columns_n < 3 || board.rows_n < 3) {
    return invalid("a board has at least 3 × 3 squares, not {} × {}", board.columns_n,
                   board.rows_n);
  }
  if (!(board.marker_m > 0 && board.square_m > board.marker_m)) {
    return invalid("a marker of {} m must be smaller than its square of {} m", board.marker_m,
                   board.square_m);
  }
  const auto dictionary = cv::aruco::getPredefinedDictionary(found->second);
  const int markers_n = board.columns_n * board.rows_n / 2;
  if (markers_n > dictionary->bytesList.rows) {
    return invalid("a board of {} × {} squares has {} markers, more than {} holds", board.columns_n,
                   board.rows_n, markers_n, board.dictionary);
  }
  return cv::aruco::CharucoBoard::create(board.columns_n, board.rows_n,
                                         static_cast<float>(board.square_m),
                                         static_cast<float>(board.marker_m), dictionary);
}

struct Markers {
  std::vector<int> ids;
  std::vector<std::vector<cv::Point2f>> corners_px;
};

Markers find_markers(const cv::Mat& image, const cv::aruco::CharucoBoard& charuco) {
  auto parameters = cv::aruco::DetectorParameters::create();
  parameters->minMarkerPerimeterRate = 0.02;
  Markers markers;
  cv::aruco::detectMarkers(image, charuco.dictionary, markers.corners_px, markers.ids, parameters);
  return markers;
}

cv::Mat enlarge(const cv::Mat& image) {
  cv::Mat enlarged;
  cv::resize(image, enlarged, {}, kEnlarged, kEnlarged, cv::INTER_CUBIC);
  return enlarged;
}

/// Our pixels' centres are at whole numbers; those of OpenCV's ChArUco corners at halves, other
/// than in the rest of OpenCV. Half a pixel is a millimetre in the bin.
double back_to_original(double enlarged_px) { return enlarged_px / kEnlarged - 0.5; }

tl::unexpected<Error> not_seen(const cv::Mat& image, const Board& board,
                               const cv::aruco::CharucoBoard& charuco, std::size_t markers_n,
                               std::size_t corners_n) {
  cv::Mat mirrored;
  cv::flip(image, mirrored, 1);
  if (find_markers(mirrored, charuco).ids.size() > markers_n) {
    return invalid("the image is mirrored: say 'mirrored: true'");
  }
  if (markers_n == 0) return invalid("no marker of {} is seen", board.dictionary);
  return invalid("{} corners of the board's {} are seen ({} markers), {} are needed", corners_n,
                 charuco.chessboardCorners.size(), markers_n, kMinCorners);
}

}  // namespace

void find_pose(BoardView& view, const CameraIntrinsics& camera) {
  std::vector<cv::Point3d> on_board;
  std::vector<cv::Point2d> in_image;
  for (std::size_t i = 0; i < view.p_px.size(); ++i) {
    on_board.emplace_back(view.p_board_m[i].x(), view.p_board_m[i].y(), view.p_board_m[i].z());
    in_image.emplace_back(view.p_px[i].x(), view.p_px[i].y());
  }
  cv::Mat rotation_vector;
  cv::Mat translation;
  cv::solvePnP(on_board, in_image, matrix_of(camera), camera.distortion, rotation_vector,
               translation);
  std::vector<cv::Point2d> projected;
  cv::projectPoints(on_board, rotation_vector, translation, matrix_of(camera), camera.distortion,
                    projected);
  double sum_px2 = 0;
  for (std::size_t i = 0; i < projected.size(); ++i) {
    const cv::Point2d off = projected[i] - in_image[i];
    sum_px2 += off.dot(off);
  }
  view.rms_px = std::sqrt(sum_px2 / static_cast<double>(projected.size()));
  cv::Mat rotation;
  cv::Rodrigues(rotation_vector, rotation);
  view.T_camera_board = pose_of(rotation, translation);
}

Result<GrayImage> read_gray_image(const std::filesystem::path& path, bool is_mirrored) {
  // Asked first, since OpenCV prints a warning of its own.
  if (!std::filesystem::is_regular_file(path))
    return invalid("{}: there is no file", path.string());
  cv::Mat image = cv::imread(path.string(), cv::IMREAD_ANYDEPTH | cv::IMREAD_GRAYSCALE);
  if (image.empty()) return invalid("{}: no image that can be read", path.string());
  if (image.depth() == CV_16U) {
    std::vector<std::uint16_t> sorted(image.begin<std::uint16_t>(), image.end<std::uint16_t>());
    const auto white = sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() * 99 / 100);
    std::nth_element(sorted.begin(), white, sorted.end());
    image.convertTo(image, CV_8U, 255.0 / std::max<int>(*white, 1));
  } else if (image.depth() != CV_8U) {
    return invalid("{}: an image of 8 or 16 bits is needed", path.string());
  }
  if (is_mirrored) cv::flip(image, image, 1);
  return GrayImage{
      image.cols, image.rows, {image.begin<std::uint8_t>(), image.end<std::uint8_t>()}};
}

Result<BoardView> find_board(const GrayImage& image, const Board& board,
                             const CameraIntrinsics& camera) {
  const auto charuco = make_charuco(board);
  if (!charuco) return tl::unexpected(charuco.error());
  const cv::Mat original(image.height_px, image.width_px, CV_8U,
                         const_cast<std::uint8_t*>(image.values.data()));
  const cv::Mat enlarged = enlarge(original);
  const Markers markers = find_markers(enlarged, **charuco);
  std::vector<cv::Point2f> corners_px;
  std::vector<int> ids;
  if (!markers.ids.empty()) {
    cv::aruco::interpolateCornersCharuco(markers.corners_px, markers.ids, enlarged, *charuco,
                                         corners_px, ids);
  }
  if (static_cast<int>(ids.size()) < kMinCorners) {
    return not_seen(enlarged, board, **charuco, markers.ids.size(), ids.size());
  }
  BoardView view;
  for (std::size_t i = 0; i < ids.size(); ++i) {
    const cv::Point3f& p = (*charuco)->chessboardCorners[static_cast<std::size_t>(ids[i])];
    view.p_board_m.emplace_back(p.x, p.y, p.z);
    view.p_px.emplace_back(back_to_original(corners_px[i].x), back_to_original(corners_px[i].y));
  }
  find_pose(view, camera);
  if (view.rms_px > kMaxRms_px) {
    return invalid(
        "the corners do not fit the board: {:.1f} px off; are its {} × {} squares and the camera's "
        "intrinsics right, and is it flat?",
        view.rms_px, board.columns_n, board.rows_n);
  }
  return view;
}

}  // namespace graspd::calibration
