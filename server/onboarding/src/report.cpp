#include "graspd/onboarding/report.hpp"

#include <fmt/format.h>

#include <cmath>

#include "graspd/onboarding/pictures.hpp"
#include "page_style.hpp"

namespace graspd::onboarding {
namespace {

constexpr std::size_t kPosePictures = 6;
constexpr std::size_t kPickPointPictures = 8;
/// Rarer ways to lie are one line together.
constexpr double kRarePose = 0.01;

std::string escaped(const std::string& text) {
  std::string safe;
  for (const char c : text) {
    switch (c) {
      case '&':
        safe += "&amp;";
        break;
      case '<':
        safe += "&lt;";
        break;
      case '>':
        safe += "&gt;";
        break;
      case '"':
        safe += "&quot;";
        break;
      default:
        safe += c;
    }
  }
  return safe;
}

/// RFC 4648.
std::string base64(const std::vector<std::uint8_t>& bytes) {
  constexpr std::string_view kLetters =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    std::uint32_t three = 0;
    for (std::size_t k = 0; k < 3; ++k)
      three = three << 8 | (i + k < bytes.size() ? bytes[i + k] : 0U);
    for (std::size_t k = 0; k < 4; ++k) {
      text += i + k <= bytes.size() ? kLetters[three >> (18 - 6 * k) & 63U] : '=';
    }
  }
  return text;
}

std::string figure(const overlay::RgbImage& image, const std::string& alternative,
                   const std::string& caption) {
  return fmt::format(
      "<figure><img width=\"{}\" height=\"{}\" alt=\"{}\" src=\"data:image/png;base64,{}\">"
      "<figcaption>{}</figcaption></figure>\n",
      image.width_px, image.height_px, escaped(alternative), base64(overlay::png_of(image)),
      caption);
}

std::string headline(const Onboarding& onboarding) {
  const Verdict verdict = verdict_of(onboarding);
  const auto [css, word] = [&]() -> std::pair<const char*, const char*> {
    switch (verdict.fitness) {
      case Fitness::kGood:
        return {"good", "Fit for this cell"};
      case Fitness::kFair:
        return {"fair", "Fit, with misses"};
      case Fitness::kPoor:
        break;
    }
    return {"poor", "Not fit as it is"};
  }();
  const auto& scene = onboarding.options.scene;
  return fmt::format(
      "<h1>New part: {}</h1>\n<p class=\"soft\">version {}, from {}; Kinect v2 {:.2f} m above a "
      "bin of "
      "{:.0f} × {:.0f} × {:.0f} mm</p>\n<p class=\"verdict {}\"><b>{}</b>{}</p>\n",
      escaped(onboarding.part.id), onboarding.version, escaped(onboarding.mesh_name),
      scene.camera_height_m, scene.bin_inner_size_m.x() * 1e3, scene.bin_inner_size_m.y() * 1e3,
      scene.bin_inner_size_m.z() * 1e3, css, word, escaped(verdict.sentence));
}

std::string advice_section(const Onboarding& onboarding) {
  const auto advice = advice_for(onboarding);
  if (advice.empty()) {
    // The headline says what is wrong with a part that is not fit, and these piles nothing more.
    if (verdict_of(onboarding).fitness == Fitness::kPoor) return "";
    return "<h2>What to change</h2>\n<p>Nothing that these piles show.</p>\n";
  }
  std::string items;
  for (const std::string& sentence : advice)
    items += fmt::format("<li>{}</li>\n", escaped(sentence));
  return fmt::format("<h2>What to change</h2>\n<ul>\n{}</ul>\n", items);
}

std::string frame_section(const Onboarding& onboarding) {
  const PlannedFrame& planned = onboarding.forecast.picture;
  return fmt::format("<h2>What the camera sees</h2>\n{}",
                     figure(overlay::draw(planned.frame, planned.request, planned.answer),
                            "depth image of the first simulated pile with what was recognised",
                            "The first simulated pile with the planner's answer."));
}

std::string forecast_section(const Onboarding& onboarding) {
  std::string rows;
  for (const Figure& line : figures_of(onboarding)) {
    rows += fmt::format(
        "<tr><th scope=\"row\">{}</th><td class=\"number\">{}</td><td class=\"number\">{}</td>"
        "<td>{}</td></tr>\n",
        escaped(line.what), escaped(line.value),
        line.interval.empty() ? "–" : escaped(line.interval), escaped(line.of));
  }
  const PileForecast& first = onboarding.forecast.piles.front();
  return fmt::format(
      "<h2>Forecast</h2>\n<p>{} of {} parts fall into the bin in physics; a simulated Kinect "
      "v2 "
      "sees each, the planner of this build plans it, and its poses are compared with the true "
      "ones: "
      "right where no point is off by more than a tenth of the part's diameter. Parts that show "
      "less "
      "than half of themselves count neither way. The intervals take parts as independent of each "
      "other, which those of one pile are not quite; a real camera and real parts will "
      "differ.</p>\n"
      "<div class=\"scroll figures\"><table><thead><tr><th scope=\"col\">What</th><th "
      "scope=\"col\">Figure</th>"
      "<th scope=\"col\">95 %</th><th "
      "scope=\"col\">Of</th></tr></thead>\n<tbody>\n{}</tbody></table></div>\n",
      onboarding.forecast.piles.size() == 1
          ? "1 pile"
          : fmt::format("{} piles", onboarding.forecast.piles.size()),
      first.parts_n, rows);
}

std::string pick_point_section(const Onboarding& onboarding) {
  const Gripper& gripper = onboarding.options.gripper;
  const auto points = jaw_points_of(onboarding.part);
  std::string pictures;
  for (std::size_t i = 0; i < std::min(points.size(), kPickPointPictures); ++i) {
    const double opening_m = opening_for(points[i], gripper);
    const bool fits = opening_m <= gripper.max_opening_m;
    pictures += figure(
        picture_of(onboarding.part, points[i], gripper), "jaws at pick point " + points[i].name,
        fmt::format("{}<br><small>{:.1f} mm wide, opens to {:.1f} mm{}</small>",
                    escaped(points[i].name), points[i].width_m * 1e3, opening_m * 1e3,
                    fits ? ""
                         : fmt::format(": <span class=\"warning\">more than {:.0f} mm</span>",
                                       gripper.max_opening_m * 1e3)));
  }
  return fmt::format(
      "<h2>Where it is grasped</h2>\n<p>{} pick points for jaws were found on the mesh{}; the "
      "part's "
      "symmetries repeat them. Teach your own in part.yaml where the mesh does not say what "
      "counts.</p>\n"
      "<div class=\"pictures\">\n{}</div>\n",
      points.size(), points.size() > kPickPointPictures ? ", the best of them here" : "", pictures);
}

std::string pose_section(const Onboarding& onboarding) {
  const auto groups = alike(onboarding.poses, onboarding.part);
  std::string pictures;
  double shown = 0;
  for (std::size_t i = 0; i < std::min(groups.size(), kPosePictures); ++i) {
    double probability = 0;
    for (const std::size_t pose : groups[i]) probability += onboarding.poses[pose].probability;
    if (i > 0 && probability < kRarePose) break;
    shown += probability;
    const StablePose& pose = onboarding.poses[groups[i].front()];
    pictures +=
        figure(picture_of(onboarding.part, pose), fmt::format("the part at rest, {}", i + 1),
               fmt::format("{:.0f} %{}<br><small>tips over at {:.0f}°</small>", 100 * probability,
                           groups[i].size() == 1 ? std::string()
                                                 : fmt::format(", {} ways alike", groups[i].size()),
                           pose.tip_rad * 180 / M_PI));
  }
  return fmt::format(
      "<h2>How it lies</h2>\n<p>On a table, alone, set down turned at random{}. In a pile parts "
      "also "
      "lean on each other.</p>\n<div class=\"pictures\">\n{}</div>\n",
      shown < 0.995 ? fmt::format("; the other {:.0f} % are rarer ways", 100 * (1 - shown)) : "",
      pictures);
}

std::string mesh_section(const Onboarding& onboarding) {
  std::string rows;
  for (const parts::MeshFinding& finding : onboarding.findings) {
    rows += fmt::format("<tr><th scope=\"row\">{}</th><td{}>{}</td><td>{}</td></tr>\n",
                        escaped(finding.topic),
                        finding.severity == parts::Severity::kOk ? "" : " class=\"warning\"",
                        name_of(finding.severity), escaped(finding.sentence));
  }
  return fmt::format(
      "<h2>The mesh</h2>\n<div class=\"scroll\"><table><tbody>\n{}</tbody></table></div>\n", rows);
}

std::string commands_section(const Onboarding& onboarding) {
  std::string lines;
  for (const std::string& command : onboarding.commands) lines += escaped(command) + "\n";
  return fmt::format(
      "<h2>Say it again</h2>\n<p>The same command gives the same figures, times "
      "apart.</p>\n<pre>{}</pre>\n",
      lines);
}

}  // namespace

std::string html_report(const Onboarding& onboarding) {
  std::string body = headline(onboarding);
  body += forecast_section(onboarding);
  body += advice_section(onboarding);
  body += frame_section(onboarding);
  body += pick_point_section(onboarding);
  body += pose_section(onboarding);
  body += mesh_section(onboarding);
  body += commands_section(onboarding);
  return fmt::format(
      "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
      "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n"
      "<title>New part: {}</title>\n<style>{}</style>\n</head>\n<body>\n<main>\n{}"
      "<footer>Made by grasp_server {}</footer>\n</main>\n</body>\n</html>\n",
      escaped(onboarding.part.id), kPageStyle, body, escaped(onboarding.build));
}

}  // namespace graspd::onboarding
