#include "graspd/command_line/progress.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <string_view>

namespace graspd {
namespace {

constexpr std::size_t kBar_n = 24;
constexpr std::chrono::milliseconds kBetweenLooks{100};
constexpr std::string_view kEraseLine = "\r\033[K";
constexpr std::string_view kGreen = "\033[32m";
constexpr std::string_view kPlain = "\033[0m";

/// One that can go back in its line.
bool is_terminal(std::FILE* stream) {
  const char* const kind = std::getenv("TERM");
  return isatty(fileno(stream)) != 0 && kind != nullptr && std::string_view(kind) != "dumb";
}

std::string repeated(std::string_view text, std::size_t times_n) {
  std::string line;
  for (std::size_t i = 0; i < times_n; ++i) line += text;
  return line;
}

}  // namespace

bool wants_colour(std::FILE* stream) {
  const char* const no_colour = std::getenv("NO_COLOR");
  return is_terminal(stream) && (no_colour == nullptr || *no_colour == '\0');
}

Progress::Progress(std::string what, std::size_t steps_n, std::FILE* stream)
    : what_(std::move(what)),
      steps_n_(steps_n),
      stream_(stream),
      is_drawn_on_(is_terminal(stream)),
      has_colour_(wants_colour(stream)) {
  if (is_drawn_on_) draw(begin_);
}

Progress::~Progress() { hide(); }

void Progress::step() {
  ++done_n_;
  if (!is_drawn_on_) return;
  const auto now = Clock::now();
  if (!is_visible_ || now - drawn_ >= kBetweenLooks) draw(now);
}

void Progress::hide() {
  if (!is_visible_) return;
  fmt::print(stream_, "{}", kEraseLine);
  std::fflush(stream_);
  is_visible_ = false;
}

void Progress::draw(Clock::time_point now) {
  std::string line = fmt::format("{} ", what_);
  if (steps_n_ == 0) {
    line += std::to_string(done_n_);
  } else {
    const std::size_t done_n = std::min(done_n_, steps_n_);
    const std::size_t full_n = kBar_n * done_n / steps_n_;
    line +=
        fmt::format("{}{}{}{} {}/{}", has_colour_ ? kGreen : "", repeated("█", full_n),
                    has_colour_ ? kPlain : "", repeated("░", kBar_n - full_n), done_n, steps_n_);
    const double elapsed_s = std::chrono::duration<double>(now - begin_).count();
    if (done_n > 0) {
      const double left_s =
          elapsed_s / static_cast<double>(done_n) * static_cast<double>(steps_n_ - done_n);
      line += fmt::format(", {:.0f} s left", left_s);
    }
  }
  fmt::print(stream_, "{}{}", kEraseLine, line);
  std::fflush(stream_);
  drawn_ = now;
  is_visible_ = true;
}

}  // namespace graspd
