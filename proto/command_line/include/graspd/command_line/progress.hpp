#pragma once

#include <chrono>
#include <cstddef>
#include <cstdio>
#include <string>

namespace graspd {

/// Whether a person looks at it who has not asked for plain text: a terminal, NO_COLOR not set.
bool wants_colour(std::FILE* stream);

/// How far long work has come, as one line that changes: a bar and the time that is left where the
/// end is known, a count where it is not. It is drawn on terminals alone, at most ten times a
/// second, and gone when the work is over.
class Progress {
 public:
  /// \param what the work, in a word or two
  /// \param steps_n how many there will be; 0: nobody knows
  explicit Progress(std::string what, std::size_t steps_n = 0, std::FILE* stream = stderr);
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  /// One more step is done.
  void step();
  /// Makes room for a line of another's, until the next step.
  void hide();

 private:
  using Clock = std::chrono::steady_clock;

  void draw(Clock::time_point now);

  std::string what_;
  std::size_t steps_n_;
  std::FILE* stream_;
  bool is_drawn_on_;
  bool has_colour_;
  bool is_visible_ = false;
  std::size_t done_n_ = 0;
  Clock::time_point begin_ = Clock::now();
  Clock::time_point drawn_;
};

}  // namespace graspd
