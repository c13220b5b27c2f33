#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "load_report.hpp"

namespace graspd::program {
namespace {

using load::Run;
using load::Sample;
using load::Summary;

constexpr double kWidth_px = 760;
constexpr double kPanelHeight_px = 300;
constexpr double kLeft_px = 70;
constexpr double kRight_px = 130;
constexpr double kTop_px = 24;
constexpr double kBottom_px = 44;

struct Point {
  double x = 0;
  double y = 0;
};

/// From a value to a place on the picture, with ticks at round values.
class Axis {
 public:
  Axis(double low, double high, double low_px, double high_px, bool is_logarithmic)
      : low_(low), high_(high), low_px_(low_px), high_px_(high_px), log_(is_logarithmic) {}

  double px(double value) const {
    return low_px_ +
           (place(value) - place(low_)) / (place(high_) - place(low_)) * (high_px_ - low_px_);
  }
  std::vector<double> ticks() const {
    std::vector<double> ticks;
    if (log_) {
      const auto exponent = [](double value) {
        return static_cast<int>(std::floor(std::log10(value)));
      };
      for (int decade = exponent(low_); decade <= exponent(high_); ++decade) {
        for (const int step : {1, 2, 5}) ticks.push_back(step * std::pow(10, decade));
      }
    } else {
      double step = std::pow(10, std::floor(std::log10((high_ - low_) / 4)));
      for (const double factor : {2.0, 2.5, 2.0}) {
        if ((high_ - low_) / step > 8) step *= factor;
      }
      const int last = static_cast<int>(std::floor(high_ / step));
      for (int i = static_cast<int>(std::ceil(low_ / step)); i <= last; ++i) {
        ticks.push_back(i * step);
      }
    }
    std::erase_if(ticks, [this](double tick) { return tick < low_ || tick > high_; });
    return ticks;
  }

 private:
  double place(double value) const { return log_ ? std::log10(std::max(value, low_)) : value; }

  double low_;
  double high_;
  double low_px_;
  double high_px_;
  bool log_;
};

/// One diagram; diagrams of a picture stand below each other.
class Panel {
 public:
  Panel(int number, const std::string& x_title, const std::string& y_title, Point low, Point high,
        bool is_logarithmic)
      : top_px_(kTop_px + number * kPanelHeight_px),
        bottom_px_(top_px_ + kPanelHeight_px - kBottom_px - kTop_px),
        x_(low.x, high.x, kLeft_px, kWidth_px - kRight_px, false),
        y_(low.y, high.y, bottom_px_, top_px_, is_logarithmic) {
    const double right_px = kWidth_px - kRight_px;
    for (const double tick : x_.ticks()) {
      line(x_.px(tick), top_px_, x_.px(tick), bottom_px_, "#e4e4e4");
      text(x_.px(tick), bottom_px_ + 16, "middle", fmt::format("{:g}", tick));
    }
    for (const double tick : y_.ticks()) {
      line(kLeft_px, y_.px(tick), right_px, y_.px(tick), "#e4e4e4");
      text(kLeft_px - 6, y_.px(tick) + 4, "end", fmt::format("{:g}", tick));
    }
    line(kLeft_px, bottom_px_, right_px, bottom_px_, "#444");
    line(kLeft_px, top_px_, kLeft_px, bottom_px_, "#444");
    text((kLeft_px + right_px) / 2, bottom_px_ + 34, "middle", x_title);
    const double middle_px = (top_px_ + bottom_px_) / 2;
    svg_ += fmt::format(
        "<text x='18' y='{0:.1f}' text-anchor='middle' transform='rotate(-90 18 {0:.1f})'>{1}"
        "</text>\n",
        middle_px, y_title);
  }

  void curve(const std::string& name, const std::string& color, const std::vector<Point>& points) {
    std::string corners;
    for (const Point& point : points) {
      corners += fmt::format("{:.1f},{:.1f} ", x_.px(point.x), y_.px(point.y));
      dot(point, color, 3);
    }
    svg_ += fmt::format("<polyline points='{}' fill='none' stroke='{}' stroke-width='2'/>\n",
                        corners, color);
    name_color(name, color);
  }
  void dots(const std::string& name, const std::string& color, const std::vector<Point>& points) {
    if (points.empty()) return;
    for (const Point& point : points) dot(point, color, 1.6);
    name_color(name, color);
  }
  void mark_x(double value, const std::string& name) {
    svg_ += fmt::format(
        "<line x1='{0:.1f}' y1='{1:.1f}' x2='{0:.1f}' y2='{2:.1f}' stroke='#888' "
        "stroke-dasharray='5 4'/>\n",
        x_.px(value), top_px_, bottom_px_);
    text(x_.px(value), top_px_ - 6, "middle", name);
  }
  const std::string& svg() const { return svg_; }

 private:
  void line(double x1, double y1, double x2, double y2, const std::string& color) {
    svg_ += fmt::format("<line x1='{:.1f}' y1='{:.1f}' x2='{:.1f}' y2='{:.1f}' stroke='{}'/>\n", x1,
                        y1, x2, y2, color);
  }
  void text(double x, double y, const std::string& anchor, const std::string& words) {
    svg_ += fmt::format("<text x='{:.1f}' y='{:.1f}' text-anchor='{}'>{}</text>\n", x, y, anchor,
                        words);
  }
  void dot(const Point& point, const std::string& color, double radius_px) {
    svg_ += fmt::format("<circle cx='{:.1f}' cy='{:.1f}' r='{}' fill='{}'/>\n", x_.px(point.x),
                        y_.px(point.y), radius_px, color);
  }
  void name_color(const std::string& name, const std::string& color) {
    const double y_px = top_px_ + 14 + 18 * static_cast<double>(named_n_++);
    const double x_px = kWidth_px - kRight_px + 14;
    svg_ +=
        fmt::format("<circle cx='{:.1f}' cy='{:.1f}' r='4' fill='{}'/>\n", x_px, y_px - 4, color);
    text(x_px + 10, y_px, "start", name);
  }

  double top_px_;
  double bottom_px_;
  Axis x_;
  Axis y_;
  int named_n_ = 0;
  std::string svg_;
};

std::string picture(const std::vector<Panel>& panels) {
  std::string svg = fmt::format(
      "<svg xmlns='http://www.w3.org/2000/svg' width='{0}' height='{1}' viewBox='0 0 {0} {1}' "
      "font-family='sans-serif' font-size='12'>\n<rect width='100%' height='100%' fill='white'/>\n",
      kWidth_px, kPanelHeight_px * static_cast<double>(panels.size()));
  for (const Panel& panel : panels) svg += panel.svg();
  return svg + "</svg>\n";
}

/// Room above and below on a logarithmic axis.
Point range_of(double low, double high) {
  return {std::max(low, 0.01) / 1.3, std::max(high, 0.02) * 1.3};
}

std::string over_time(const Run& run) {
  std::vector<Point> ok;
  std::vector<Point> others;
  double end_s = 0.1;
  double low_ms = 1e9;
  double high_ms = 0;
  for (const Sample& sample : run.samples) {
    if (sample.planned_s < 0) continue;  // the warm-up
    (sample.code == Code::kOk ? ok : others).push_back({sample.planned_s, sample.ended_ms});
    end_s = std::max(end_s, sample.planned_s);
    low_ms = std::min(low_ms, sample.ended_ms);
    high_ms = std::max(high_ms, sample.ended_ms);
  }
  const Point ms = range_of(low_ms, high_ms);
  Panel panel(0, "planned at, s", "latency, ms", {0, ms.x}, {end_s, ms.y}, true);
  panel.dots("OK", "#0072b2", ok);
  panel.dots("refused", "#d55e00", others);
  return picture({panel});
}

std::string over_rate(const LoadResult& result) {
  const auto curve = [&](const auto& value_of) {
    std::vector<Point> points;
    for (const Run& run : result.runs) {
      if (run.rate_hz > 0 && run.summary.ok_n > 0)
        points.push_back({run.rate_hz, value_of(run.summary)});
    }
    return points;
  };
  const auto p50 = curve([](const Summary& seen) { return seen.latency_ms.p50; });
  const auto p90 = curve([](const Summary& seen) { return seen.latency_ms.p90; });
  const auto p99 = curve([](const Summary& seen) { return seen.latency_ms.p99; });
  const auto goodput = curve([](const Summary& seen) { return seen.goodput_hz; });
  double low_ms = 1e9;
  double high_ms = 0;
  double most_hz = 0.1;
  for (std::size_t i = 0; i < p50.size(); ++i) {
    low_ms = std::min(low_ms, p50[i].y);
    high_ms = std::max(high_ms, p99[i].y);
    most_hz = std::max(most_hz, p50[i].x);
  }
  const Point ms = range_of(low_ms, high_ms);
  Panel latency(0, "asked, frames/s", "latency, ms", {0, ms.x}, {most_hz * 1.05, ms.y}, true);
  latency.curve("p99", "#d55e00", p99);
  latency.curve("p90", "#e69f00", p90);
  latency.curve("p50", "#0072b2", p50);
  Panel answered(1, "asked, frames/s", "answered OK, frames/s", {0, 0},
                 {most_hz * 1.05, most_hz * 1.05}, false);
  answered.curve("answered", "#0072b2", goodput);
  answered.dots("asked", "#999999", curve([](const Summary& seen) { return seen.asked_hz; }));
  if (result.capacity_hz && *result.capacity_hz > 0) {
    latency.mark_x(*result.capacity_hz, fmt::format("capacity {:.1f}/s", *result.capacity_hz));
    answered.mark_x(*result.capacity_hz, "");
  }
  return picture({latency, answered});
}

}  // namespace

std::string load_picture(const LoadResult& result) {
  return result.runs.size() == 1 ? over_time(result.runs.front()) : over_rate(result);
}

}  // namespace graspd::program
