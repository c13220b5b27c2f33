#include <spdlog/spdlog.h>

#include <cmath>
#include <filesystem>

#include "commands.hpp"
#include "graspd/calibration/depth_fit.hpp"
#include "graspd/calibration/hand_eye.hpp"
#include "graspd/calibration/views.hpp"
#include "graspd/command_line/help.hpp"
#include "graspd/command_line/progress.hpp"
#include "graspd/command_line/run_program.hpp"
#include "graspd/formats/cell.hpp"

namespace graspd::robot_agent {
namespace {

constexpr double kRadToDeg = 180 / M_PI;

struct CalibrateArguments {
  std::filesystem::path views;
  std::filesystem::path camera;
  std::filesystem::path output;
};

/// The views that show the board, by what they are good for.
struct UsableViews {
  std::vector<calibration::FlangeView> flange;
  std::vector<calibration::DepthView> depth;
};

Result<UsableViews> find_boards(calibration::Recording recording) {
  UsableViews usable;
  std::string last_fault;
  Progress progress("looking for the board", recording.views.size());
  for (calibration::RecordedView& view : recording.views) {
    const auto board = calibration::find_board(view.image, recording.board, recording.camera);
    progress.step();
    if (!board) {
      progress.hide();
      last_fault = fmt::format("{}: {}", view.name, board.error().message);
      spdlog::warn("{}; left out", last_fault);
      continue;
    }
    if (view.T_base_flange) usable.flange.push_back({view.name, *view.T_base_flange, *board});
    if (view.depth) {
      usable.depth.push_back({view.name, *std::move(view.depth), board->T_camera_board});
    }
  }
  if (!usable.flange.empty() || !usable.depth.empty()) return usable;
  if (!last_fault.empty()) return invalid("no view shows the board; {}", last_fault);
  return invalid("no view has a 'T_base_flange' or a 'depth': there is nothing to calibrate");
}

void print(const calibration::HandEye& hand_eye, std::size_t views_n) {
  fmt::print(
      "camera pose from {} views: held out {:.2f} mm and {:.3f}° RMS; corners {:.2f} px RMS; "
      "squares fit {:.2f} mm\n",
      views_n, hand_eye.position_rms_m * 1e3, hand_eye.rotation_rms_rad * kRadToDeg,
      hand_eye.reprojection_rms_px, hand_eye.square_m * 1e3);
  for (const calibration::ViewError& view : hand_eye.held_out) {
    const bool sticks_out = view.position_m > 3 * hand_eye.position_rms_m;
    fmt::print("  {:<24} {:>6.2f} mm {:>7.3f}°{}\n", view.name, view.position_m * 1e3,
               view.rotation_rad * kRadToDeg,
               sticks_out ? "  sticks out: was the arm still, is the pose right?" : "");
  }
}

void print(const calibration::DepthFit& fit, std::size_t views_n) {
  fmt::print(
      "depth correction from {} views, {} readings over {:.0f} % of the image, "
      "{:.2f} to {:.2f} m:\n"
      "  before    mean {:>6.2f} mm, RMS {:>5.2f} mm, bias {:>5.2f} mm\n"
      "  held out  mean {:>6.2f} mm, RMS {:>5.2f} mm, bias {:>5.2f} mm\n",
      views_n, fit.readings_n, fit.image_share * 100, fit.correction.min_depth_m,
      fit.correction.max_depth_m, fit.before.mean_m * 1e3, fit.before.rms_m * 1e3,
      fit.bias_before_m * 1e3, fit.held_out.mean_m * 1e3, fit.held_out.rms_m * 1e3,
      fit.bias_held_out_m * 1e3);
}

Result<void> calibrate(const CalibrateArguments& arguments) {
  auto camera = read_camera(arguments.camera);
  if (!camera) return tl::unexpected(camera.error());
  auto recording =
      calibration::read_recording(arguments.views, camera->camera, camera->depth_scale_m);
  if (!recording) return tl::unexpected(recording.error());
  camera->camera = recording->camera;
  const calibration::Board board = recording->board;
  const auto usable = find_boards(*std::move(recording));
  if (!usable) return tl::unexpected(usable.error());

  if (!usable->flange.empty()) {
    const auto hand_eye = calibration::calibrate_hand_eye(usable->flange, board, camera->camera);
    if (!hand_eye) return tl::unexpected(hand_eye.error());
    print(*hand_eye, usable->flange.size());
    camera->T_base_camera = hand_eye->T_base_camera;
  }
  if (!usable->depth.empty()) {
    const auto fit = calibration::fit_depth_correction(usable->depth, board, camera->camera);
    if (!fit) return tl::unexpected(fit.error());
    print(*fit, usable->depth.size());
    camera->depth_correction = fit->correction;
  }
  return write_camera(arguments.output, *camera);
}

}  // namespace

void add_calibrate_command(CLI::App& app) {
  const auto arguments = std::make_shared<CalibrateArguments>();
  CLI::App* command =
      app.add_subcommand("calibrate", "find where the camera stands, and what its depth is off by");
  command->add_option("--views", arguments->views, "folder with images and poses.yaml")
      ->required()
      ->type_name("DIR");
  command
      ->add_option("--camera", arguments->camera,
                   "the camera's intrinsics, an OpenCV calibration file")
      ->required()
      ->type_name("FILE");
  command
      ->add_option("--out", arguments->output, "the same with T_base_camera and depth_correction")
      ->required()
      ->type_name("FILE");
  set_help(
      *command,
      "poses.yaml:\n"
      "  board: {columns_n: 7, rows_n: 5, square_m: 0.04, marker_m: 0.03}   # ChArUco, measured\n"
      "  mirrored: true     # images and intrinsics are as a Kinect delivers them; default: false\n"
      "  views:\n"
      "    - image: ir_00.png\n"
      "      T_base_flange: [16 numbers, row by row, metres]   # board on the flange: camera pose\n"
      "      depth: depth_00.png                               # depth correction\n\n"
      "Both are optional in each view. Keys of board that may be left out: dictionary "
      "(DICT_4X4_50) and margin_m (0), the plain margin of the plate: where there is one, only it "
      "is read for the depth, since what is read may depend on how dark the print is. What is "
      "written is for images mirrored back.",
      {"robot_agent calibrate --views board --camera kinect.yaml --out camera.yaml"});
  command->callback([arguments] {
    const auto done = calibrate(*arguments);
    if (done) return;
    spdlog::error("{}", done.error().message);
    throw CLI::RuntimeError(kExitWrongInput);
  });
}

}  // namespace graspd::robot_agent
