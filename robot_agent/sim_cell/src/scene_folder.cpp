#include "graspd/sim_cell/scene_folder.hpp"

#include <algorithm>
#include <deque>
#include <future>
#include <thread>

#include "graspd/recordings/rawlog.hpp"

namespace graspd::sim_cell {
namespace {

constexpr double kFramePeriod_s = 1.0 / 30;
constexpr double kHalfVisible = 0.5;

/// Frames 0, 1, 2 … in order, made on all cores.
class FramesAhead {
 public:
  FramesAhead(const simulation::SceneMaker& maker, int frames_n)
      : maker_(maker), frames_n_(frames_n) {
    const unsigned cores_n = std::max(1U, std::thread::hardware_concurrency());
    while (frames_.size() < cores_n && start_one()) continue;
  }

  Result<BopImage> next() {
    auto frame = std::move(frames_.front());
    frames_.pop_front();
    auto image = frame.get();
    start_one();
    return image;
  }

 private:
  bool start_one() {
    if (started_n_ == frames_n_) return false;
    frames_.push_back(
        std::async(std::launch::async, [this, k = started_n_] { return maker_.make(k); }));
    ++started_n_;
    return true;
  }

  const simulation::SceneMaker& maker_;
  int frames_n_;
  int started_n_ = 0;
  std::deque<std::future<Result<BopImage>>> frames_;
};

}  // namespace

Result<SceneReport> simulate_scene(const parts::Catalogue& catalogue,
                                   const simulation::SceneOptions& options,
                                   const std::filesystem::path& directory,
                                   const std::function<void(int)>& progress) {
  const auto maker = simulation::SceneMaker::create(catalogue, options);
  if (!maker) return tl::unexpected(maker.error());
  std::error_code error;
  std::filesystem::create_directories(directory, error);
  if (error) return invalid("{}: can't be made: {}", directory.string(), error.message());
  BopSceneWriter scene(directory);
  auto rawlog = RawlogWriter::create(directory / "frames.rawlog");
  if (!rawlog) return tl::unexpected(rawlog.error());

  SceneReport report;
  int visible_n = 0;
  FramesAhead frames(*maker, options.frames_n);
  for (int k = 0; k < options.frames_n; ++k) {
    const auto image = frames.next();
    if (!image) return tl::unexpected(image.error());
    if (auto ok = scene.add(*image); !ok) return tl::unexpected(ok.error());
    if (auto ok = rawlog->add(image->frame, k * kFramePeriod_s); !ok) {
      return tl::unexpected(ok.error());
    }
    ++report.frames_n;
    report.parts_n += static_cast<int>(image->truth.size());
    for (const BopTruth& truth : image->truth) visible_n += truth.visible_fraction >= kHalfVisible;
    if (progress) progress(k + 1);
  }
  if (auto ok = scene.finish(); !ok) return tl::unexpected(ok.error());
  if (auto ok = rawlog->finish(); !ok) return tl::unexpected(ok.error());
  report.visible_share = report.parts_n == 0 ? 0 : double(visible_n) / report.parts_n;
  return report;
}

}  // namespace graspd::sim_cell
