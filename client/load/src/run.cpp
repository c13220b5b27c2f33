#include "graspd/load/run.hpp"

#include <sys/resource.h>

#include <algorithm>
#include <cmath>
#include <span>
#include <thread>

namespace graspd::load {
namespace {

using Seconds = std::chrono::duration<double>;

constexpr std::size_t kStableWindows_n = 3;
constexpr double kStableShare = 0.1;
constexpr std::chrono::milliseconds kLook{50};
// How long the last window may take beyond its end, where requests take so long to end, or this
// machine to send them.
constexpr int kPatience_windows = 2;

double seconds(Clock::duration time) { return Seconds(time).count(); }
double milliseconds(Clock::duration time) { return seconds(time) * 1e3; }

double cpu_s() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  const auto time_s = [](const timeval& time) {
    return static_cast<double>(time.tv_sec) + static_cast<double>(time.tv_usec) / 1e6;
  };
  return time_s(usage.ru_utime) + time_s(usage.ru_stime);
}

/// Keeps every request, and knows which windows are over: one was planned after them and all of
/// their own have ended, so that what is slow to end still counts where it was planned.
class Recorder {
 public:
  Recorder(TimePoint begin, Seconds window) : begin_(begin), window_(window) {}

  void asked(const Asked& asked) {
    const std::lock_guard lock(mutex_);
    latest_ = std::max(latest_, asked.planned);
    if (std::size_t* open_n = open_in_window_of(asked.planned)) ++*open_n;
  }
  void ended(const Ended& ended) {
    const auto since_planned_ms = [&](TimePoint at) { return milliseconds(at - ended.planned); };
    Sample sample;
    sample.cell = ended.cell;
    sample.planned_s = seconds(ended.planned - begin_);
    sample.handed_over_ms = since_planned_ms(ended.handed_over);
    if (ended.end.sent) sample.sent_ms = since_planned_ms(*ended.end.sent);
    sample.ended_ms = since_planned_ms(ended.end.ended);
    if (ended.end.answer) {
      sample.timings = ended.end.answer->timings;
    } else {
      sample.code = ended.end.answer.error().code;
    }
    const std::lock_guard lock(mutex_);
    if (std::size_t* open_n = open_in_window_of(ended.planned)) --*open_n;
    samples_.push_back(std::move(sample));
  }
  /// \returns what was seen of the window, where it is over.
  std::optional<Summary> window(std::size_t number, std::size_t cells_n) const {
    const double begin_s = window_.count() * static_cast<double>(number);
    const std::lock_guard lock(mutex_);
    const bool is_over = seconds(latest_ - begin_) >= begin_s + window_.count() &&
                         (number >= open_n_.size() || open_n_[number] == 0);
    if (!is_over) return std::nullopt;
    return summarise(samples_, begin_s, begin_s + window_.count(), cells_n);
  }
  /// When nothing is in flight.
  std::vector<Sample> take() { return std::move(samples_); }

 private:
  /// Null in the warm-up.
  std::size_t* open_in_window_of(TimePoint planned) {
    if (planned < begin_) return nullptr;
    const auto number = static_cast<std::size_t>(seconds(planned - begin_) / window_.count());
    if (open_n_.size() <= number) open_n_.resize(number + 1);
    return &open_n_[number];
  }

  TimePoint begin_;
  Seconds window_;
  mutable std::mutex mutex_;
  TimePoint latest_;
  std::vector<std::size_t> open_n_;  ///< asked and not ended, of each window
  std::vector<Sample> samples_;
};

bool is_near(double value, double mean) { return std::abs(value - mean) <= kStableShare * mean; }

template <class Value>
bool are_near(std::span<const Summary> windows, const Value& value_of) {
  double sum = 0;
  for (const Summary& window : windows) sum += value_of(window);
  const double mean = sum / static_cast<double>(windows.size());
  return std::all_of(windows.begin(), windows.end(),
                     [&](const Summary& window) { return is_near(value_of(window), mean); });
}

/// Asks until it is told to stop, on a thread of its own.
class Driver {
 public:
  Driver(Generator& generator, const Load& load, TimePoint start) {
    if (const auto* closed = std::get_if<ClosedLoad>(&load)) {
      closed_.emplace(generator, closed->in_flight_n);
    } else {
      thread_ = std::thread([this, &generator, pace = std::get<OpenLoad>(load).pace(start)] {
        run_open_loop(generator, pace, [this](const Due&) { return !stop_; });
      });
    }
  }
  ~Driver() { stop(); }
  Driver(const Driver&) = delete;
  Driver& operator=(const Driver&) = delete;

  void stop() {
    stop_ = true;
    if (thread_.joinable()) thread_.join();
    closed_.reset();
  }

 private:
  std::atomic<bool> stop_ = false;
  std::thread thread_;
  std::optional<ClosedLoop> closed_;
};

}  // namespace

bool are_stable(const std::vector<Summary>& windows) {
  if (windows.size() < kStableWindows_n) return false;
  const std::span last(windows.end() - kStableWindows_n, windows.end());
  return are_near(last, [](const Summary& window) { return window.goodput_hz; }) &&
         are_near(last, [](const Summary& window) { return window.latency_ms.p50; });
}

Run run_load(const GeneratorMaker& make, const Load& load, const RunOptions& options,
             const std::function<void(const Run&)>& progress) {
  std::optional<Recorder> recorder;
  const auto generator = make({[&](const Asked& asked) { recorder->asked(asked); },
                               [&](const Ended& ended) { recorder->ended(ended); }});
  const TimePoint start = Clock::now();
  const TimePoint begin = start + std::chrono::ceil<Clock::duration>(options.warm_up);
  recorder.emplace(begin, options.window);
  const TimePoint end = begin + std::chrono::ceil<Clock::duration>(
                                    options.window * (options.max_windows_n + kPatience_windows));
  const auto is_done = [&](const Run& run) {
    return run.is_stable || static_cast<int>(run.windows.size()) == options.max_windows_n;
  };
  Run run;
  run.summary.cells.resize(generator->cells_n());
  if (const auto* open = std::get_if<OpenLoad>(&load)) {
    run.is_open = true;
    run.rate_hz = open->rate_hz;
  }
  const auto look = [&] {
    while (!is_done(run)) {
      auto window = recorder->window(run.windows.size(), generator->cells_n());
      if (!window) return;
      run.windows.push_back(*std::move(window));
      run.is_stable = are_stable(run.windows);
      progress(run);
    }
  };

  Driver driver(*generator, load, start);
  std::this_thread::sleep_until(begin);
  const double cpu_before_s = cpu_s();
  while (!is_done(run) && Clock::now() < end) {
    std::this_thread::sleep_for(kLook);
    look();
  }
  run.cpu_share = (cpu_s() - cpu_before_s) / seconds(Clock::now() - begin);
  driver.stop();
  generator->wait_until_idle();
  look();

  run.samples = recorder->take();
  const double window_s = options.window.count();
  double end_s = window_s * static_cast<double>(run.windows.size());
  double begin_s = run.is_stable ? end_s - window_s * kStableWindows_n : 0;
  if (run.windows.empty() && !run.samples.empty()) {
    // This machine was so late, or answers were so slow, that no window came to its end.
    const auto [first, last] = std::minmax_element(
        run.samples.begin(), run.samples.end(),
        [](const Sample& a, const Sample& b) { return a.planned_s < b.planned_s; });
    begin_s = first->planned_s;
    end_s = last->planned_s;
  }
  if (end_s > begin_s) run.summary = summarise(run.samples, begin_s, end_s, generator->cells_n());
  return run;
}

}  // namespace graspd::load
