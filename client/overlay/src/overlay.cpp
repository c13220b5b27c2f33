#include "graspd/overlay/overlay.hpp"

#include <algorithm>
#include <map>
#include <opencv2/imgcodecs.hpp>
#include <set>

#include "canvas.hpp"
#include "depth_picture.hpp"
#include "graspd/types/camera_model.hpp"

namespace graspd::overlay {
namespace {

// Of Okabe and Ito's eight colours those that neither the best grasp nor the ground is near to.
constexpr Color kOutlineColors[] = {
    {86, 180, 233}, {240, 228, 66}, {0, 190, 140}, {230, 150, 200}, {120, 140, 255}};
constexpr Color kStripColor{32, 32, 38};
constexpr Color kTextColor{235, 235, 235};
constexpr int kLine_px = 26;
constexpr double kText_px = 11;
constexpr double kLabel_px = 10;
constexpr double kLabelDistance_px = 14;

const Color& outline_color(std::uint32_t object_id) {
  return kOutlineColors[object_id % std::size(kOutlineColors)];
}

/// Points of one grasp's frame in the picture.
class GraspView {
 public:
  GraspView(const View& view, const DepthFrame& frame, const PlanRequest& request,
            const Grasp& grasp)
      : view_(view),
        camera_(frame.camera),
        T_camera_grasp_(request.T_base_camera.inverse() * grasp.T_base_grasp) {}

  /// No grasp point is behind a camera that saw the part; one that is can't be drawn.
  bool visible() const { return T_camera_grasp_.translation().z() > 0.01; }
  cv::Point2d operator()(double x_m, double y_m) const {
    const Eigen::Vector2d pixel = project(camera_, T_camera_grasp_ * Eigen::Vector3d(x_m, y_m, 0));
    return {view_.x(pixel.x()), view_.y(pixel.y())};
  }

 private:
  const View& view_;
  const CameraIntrinsics& camera_;
  Eigen::Isometry3d T_camera_grasp_;
};

void draw_grasp(cv::Mat& picture, const GraspView& view, const Grasp& grasp, const Gripper& gripper,
                const Color& color, int thickness_px) {
  const double inner_m = grasp.opening_width_m / 2;
  const double outer_m = inner_m + gripper.jaw_size_m.x();
  const double half_m = gripper.jaw_size_m.y() / 2;
  draw_line(picture, {view(-inner_m, 0), view(inner_m, 0)}, false, color, thickness_px);
  for (const double side : {-1.0, 1.0}) {
    fill_polygon(picture,
                 {view(side * inner_m, -half_m), view(side * outer_m, -half_m),
                  view(side * outer_m, half_m), view(side * inner_m, half_m)},
                 color);
  }
}

struct RankedGrasp {
  const Grasp* grasp;
  std::size_t rank;
};

/// Each object's best grasp, the best of all last, so that it is drawn on top.
std::vector<RankedGrasp> best_grasps(const PlanAnswer& answer) {
  std::vector<RankedGrasp> best;
  std::set<std::uint32_t> seen;
  for (std::size_t i = 0; i < answer.grasps.size(); ++i) {
    if (seen.insert(answer.grasps[i].object_id).second) best.push_back({&answer.grasps[i], i + 1});
  }
  std::reverse(best.begin(), best.end());
  return best;
}

void draw_outlines(cv::Mat& picture, const View& view, const PlanAnswer& answer) {
  for (const Object& object : answer.objects) {
    std::vector<cv::Point2d> points;
    for (std::size_t i = 0; i + 1 < object.outline_px.size(); i += 2) {
      points.emplace_back(view.x(object.outline_px[i]), view.y(object.outline_px[i + 1]));
    }
    draw_line(picture, points, true, outline_color(object.id), 2);
  }
}

/// Beside the jaw that is farther up in the picture, where it hides neither part nor jaws.
cv::Point2d label_place(const GraspView& view, const Grasp& grasp, const Gripper& gripper) {
  const double outer_m = grasp.opening_width_m / 2 + gripper.jaw_size_m.x();
  const double side = view(outer_m, 0).y < view(-outer_m, 0).y ? 1 : -1;
  const cv::Point2d edge = view(side * outer_m, 0);
  const cv::Point2d out = edge - view(0, 0);
  return edge + out * (kLabelDistance_px / std::max(1.0, cv::norm(out)));
}

void draw_grasps(cv::Mat& picture, const View& view, const DepthFrame& frame,
                 const PlanRequest& request, const PlanAnswer& answer) {
  const std::vector<RankedGrasp> ranked = best_grasps(answer);
  for (const auto& [grasp, rank] : ranked) {
    const GraspView grasp_view(view, frame, request, *grasp);
    if (!grasp_view.visible()) continue;
    const bool best = rank == 1;
    draw_grasp(picture, grasp_view, *grasp, request.gripper, best ? kBestGraspColor : kGraspColor,
               best ? 4 : 2);
  }
  // Ranks last: a jaw must not hide a number.
  for (const auto& [grasp, rank] : ranked) {
    const GraspView grasp_view(view, frame, request, *grasp);
    if (!grasp_view.visible()) continue;
    draw_label(picture, std::to_string(rank), label_place(grasp_view, *grasp, request.gripper),
               rank == 1 ? kLabel_px + 3 : kLabel_px, rank == 1 ? kBestGraspColor : kGraspColor);
  }
}

std::string caption(const PlanAnswer& answer) {
  std::map<std::string, int> count_of_part;
  for (const Object& object : answer.objects) ++count_of_part[object.part_id];
  std::string parts;
  for (const auto& [part, count] : count_of_part) {
    parts += fmt::format("{}{} {}", parts.empty() ? "" : ", ", count, part);
  }
  return fmt::format("{}: {} object{}{}, {} grasp{}", name_of(answer.outcome),
                     answer.objects.size(), answer.objects.size() == 1 ? "" : "s",
                     parts.empty() ? "" : " (" + parts + ")", answer.grasps.size(),
                     answer.grasps.size() == 1 ? "" : "s");
}

/// Breaks at spaces into lines that fit.
std::vector<std::string> wrap(const std::string& text, int width_px) {
  std::vector<std::string> lines;
  std::string line;
  std::size_t begin = 0;
  while (begin < text.size()) {
    const std::size_t end = std::min(text.find(' ', begin), text.size());
    const std::string word = text.substr(begin, end - begin);
    const std::string longer = line.empty() ? word : fmt::format("{} {}", line, word);
    if (!line.empty() && text_width_px(longer, kText_px) > width_px) {
      lines.push_back(line);
      line = word;
    } else {
      line = longer;
    }
    begin = end + 1;
  }
  if (!line.empty()) lines.push_back(line);
  return lines;
}

/// A small sign for the legend: jaws and closing line, lying.
void draw_grasp_sign(cv::Mat& strip, cv::Point2d centre, const Color& color, int thickness_px) {
  draw_line(strip, {centre - cv::Point2d(12, 0), centre + cv::Point2d(12, 0)}, false, color,
            thickness_px);
  for (const double side : {-1.0, 1.0}) {
    const double x = centre.x + side * 14;
    fill_polygon(strip,
                 {{x - 3, centre.y - 7},
                  {x + 3, centre.y - 7},
                  {x + 3, centre.y + 7},
                  {x - 3, centre.y + 7}},
                 color);
  }
}

/// Signs and what they mean, as many to a line as fit.
class Legend {
 public:
  Legend(cv::Mat& strip, int top_px) : strip_(strip), y_px_(top_px) {}

  template <class DrawSign>
  void add(int sign_width_px, DrawSign draw_sign, const std::string& text) {
    const int width_px = sign_width_px + 8 + text_width_px(text, kText_px);
    if (x_px_ > kMargin_px && x_px_ + width_px > strip_.cols - kMargin_px) {
      x_px_ = kMargin_px;
      y_px_ += kLine_px;
    }
    draw_sign(cv::Point2d(x_px_ + sign_width_px / 2.0, y_px_ - kText_px / 2));
    draw_text(strip_, text, {x_px_ + sign_width_px + 8, y_px_}, kText_px, kTextColor);
    x_px_ += width_px + 24;
  }
  int bottom_px() const { return y_px_; }

  static constexpr int kMargin_px = 12;

 private:
  cv::Mat& strip_;
  int x_px_ = kMargin_px;
  int y_px_;
};

/// Explains the signs that the picture has. \returns where it ends.
int draw_legend(cv::Mat& strip, int top_px, const PlanAnswer& answer) {
  Legend legend(strip, top_px);
  const auto add_grasp = [&](const Color& color, int thickness_px, const std::string& text) {
    legend.add(
        36, [&](cv::Point2d centre) { draw_grasp_sign(strip, centre, color, thickness_px); }, text);
  };
  if (!answer.grasps.empty()) add_grasp(kBestGraspColor, 4, "best grasp: jaws, open");
  if (answer.grasps.size() > 1) add_grasp(kGraspColor, 2, "other objects' best grasps, by rank");
  const bool outlined =
      std::any_of(answer.objects.begin(), answer.objects.end(),
                  [](const Object& object) { return !object.outline_px.empty(); });
  if (outlined) {
    legend.add(
        60,
        [&](cv::Point2d centre) {
          for (int i = 0; i < 3; ++i) {
            const double x = centre.x - 30 + 20.0 * i;
            draw_line(strip, {{x + 2, centre.y}, {x + 18, centre.y}}, false, kOutlineColors[i], 2);
          }
        },
        "recognised parts");
  }
  legend.add(
      20,
      [&](cv::Point2d centre) {
        const cv::Point2d half(9, 6);
        const cv::Point2d other(9, -6);
        fill_polygon(strip, {centre - half, centre + other, centre + half, centre - other},
                     kNoReadingColor);
      },
      "no reading");
  return legend.bottom_px();
}

cv::Mat draw_strip(int width_px, const PlanAnswer& answer) {
  constexpr int kMargin_px = Legend::kMargin_px;
  constexpr int kMostLegendLines = 4;
  const int text_px = width_px - 2 * kMargin_px;
  const std::vector<std::string> headline = wrap(caption(answer), text_px);
  const std::vector<std::string> reason = wrap(answer.reason, text_px);
  const auto lines = static_cast<int>(headline.size() + reason.size());
  cv::Mat strip(kLine_px * (lines + kMostLegendLines + 1), width_px, CV_8UC3, bgr(kStripColor));
  int y_px = kLine_px;
  for (const std::string& line : headline) {
    draw_text(strip, line, {kMargin_px, y_px}, kText_px + 2, kTextColor);
    y_px += kLine_px;
  }
  for (const std::string& line : reason) {
    draw_text(strip, line, {kMargin_px, y_px}, kText_px, kTextColor);
    y_px += kLine_px;
  }
  const int bottom_px = draw_legend(strip, y_px, answer);
  return strip.rowRange(0, std::min(strip.rows, bottom_px + kLine_px / 2));
}

cv::Mat_<cv::Vec3b> bgr_of(const RgbImage& image) {
  cv::Mat_<cv::Vec3b> picture(image.height_px, image.width_px);
  std::transform(image.pixels.begin(), image.pixels.end(), picture.begin(),
                 [](const auto& pixel) { return cv::Vec3b(pixel[2], pixel[1], pixel[0]); });
  return picture;
}

}  // namespace

RgbImage draw(const DepthFrame& frame, const PlanRequest& request, const PlanAnswer& answer) {
  const View view = view_of(frame, request);
  cv::Mat picture = depth_picture(frame, request, view);
  draw_outlines(picture, view, answer);
  draw_grasps(picture, view, frame, request, answer);
  const cv::Mat strip = draw_strip(picture.cols, answer);
  cv::vconcat(picture, strip, picture);

  RgbImage image{picture.cols, picture.rows, {}};
  image.pixels.reserve(picture.total());
  for (const auto& pixel : cv::Mat_<cv::Vec3b>(picture)) {
    image.pixels.push_back({pixel[2], pixel[1], pixel[0]});
  }
  return image;
}

std::vector<std::uint8_t> png_of(const RgbImage& image) {
  std::vector<std::uint8_t> bytes;
  cv::imencode(".png", bgr_of(image), bytes);
  return bytes;
}

Result<void> write_png(const std::filesystem::path& path, const RgbImage& image) {
  const cv::Mat_<cv::Vec3b> picture = bgr_of(image);
  bool written = false;
  try {
    written = cv::imwrite(path.string(), picture);
  } catch (const cv::Exception&) {
    written = false;
  }
  if (!written) {
    return invalid("{}: can't be written; does the folder exist, does the name end in .png?",
                   path.string());
  }
  return {};
}

}  // namespace graspd::overlay
