#include "graspd/record/run_recorder.hpp"

#include <fmt/chrono.h>

#include <fstream>
#include <optional>

#include "graspd/codec/codec.hpp"
#include "graspd/formats/bop.hpp"
#include "graspd/record/json_lines.hpp"
#include "graspd/record/pick_json.hpp"
#include "json.hpp"

namespace graspd::record {
namespace {

namespace fs = std::filesystem;
using SystemTime = std::chrono::system_clock::time_point;

std::string utc(SystemTime time) {
  return fmt::format("{:%Y-%m-%dT%H:%M:%SZ}",
                     fmt::gmtime(std::chrono::system_clock::to_time_t(time)));
}

/// A folder that was not there before.
Result<fs::path> new_folder(const fs::path& runs, const std::string& name) {
  std::error_code error;
  fs::create_directories(runs, error);
  for (int n = 1; !error; ++n) {
    fs::path folder = runs / (n == 1 ? name : fmt::format("{}-{}", name, n));
    if (fs::create_directory(folder, error)) return folder;
  }
  return invalid("{}: no folder can be made for the run's records ({})", runs.string(),
                 error.message());
}

Result<void> write_file(const fs::path& path, std::string_view text) {
  std::error_code error;
  fs::create_directories(path.parent_path(), error);
  std::ofstream file(path);
  file << text << '\n' << std::flush;
  if (!file) {
    return fail(Code::kInternal, "{}: can't be written; is the disk full?", path.string());
  }
  return {};
}

}  // namespace

struct RunRecorder::Impl {
  fs::path folder;
  std::string cell;
  SystemTime start;
  JsonLines picks;
  std::optional<BopSceneWriter> frames;

  Result<void> write_run(std::string_view state, std::string_view reason, const Json& end) const {
    const Json run = {
        {"cell", cell}, {"start", utc(start)}, {"end", end}, {"state", state}, {"reason", reason}};
    return write_file(folder / "run.json", to_line(run));
  }
};

Result<RunRecorder> RunRecorder::create(const fs::path& runs, const std::string& cell,
                                        SystemTime now, bool keep_frames) {
  std::string name = fmt::format("{}_{}", cell, utc(now));
  std::ranges::replace(name, ':', '-');
  std::ranges::replace(name, '/', '-');
  auto folder = new_folder(runs, name);
  if (!folder) return tl::unexpected(folder.error());
  auto picks = JsonLines::create(*folder / "picks.jsonl");
  if (!picks) return tl::unexpected(picks.error());
  auto impl = std::make_unique<Impl>(Impl{*folder, cell, now, *std::move(picks), std::nullopt});
  if (keep_frames) impl->frames.emplace(*folder / "frames");
  if (auto ok = impl->write_run("RUNNING", "", nullptr); !ok) return tl::unexpected(ok.error());
  return RunRecorder(std::move(impl));
}

RunRecorder::RunRecorder(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
RunRecorder::RunRecorder(RunRecorder&&) noexcept = default;
RunRecorder& RunRecorder::operator=(RunRecorder&&) noexcept = default;
RunRecorder::~RunRecorder() = default;

const fs::path& RunRecorder::folder() const { return impl_->folder; }

Result<void> RunRecorder::planned(std::uint64_t frame_n, const DepthFrame& frame,
                                  const PlanRequest& request, const Result<PlanAnswer>& answer) {
  const std::string file = fmt::format("{:06}.json", frame_n);
  if (impl_->frames) {
    BopImage image;
    image.im_id = static_cast<int>(frame_n);
    image.frame = frame;
    image.T_world_camera = request.T_base_camera;
    if (request.bin) {
      image.bin = BopBin{request.T_base_camera.inverse() * request.bin->T_base_bin,
                         request.bin->inner_size_m};
    }
    if (auto ok = impl_->frames->add(image); !ok) return ok;
  }
  auto ok = write_file(impl_->folder / "requests" / file, codec::to_json(request, true));
  if (!ok || !answer) return ok;
  return write_file(impl_->folder / "answers" / file, codec::to_json(*answer, true));
}

Result<void> RunRecorder::finished(const agent::PickRecord& record) {
  return impl_->picks.add(to_json(record));
}

Result<void> RunRecorder::ended(std::string_view state, const std::string& reason, SystemTime now) {
  // A scene without an image is none.
  const bool has_frames = impl_->frames && fs::exists(impl_->folder / "frames");
  if (has_frames) {
    if (auto ok = impl_->frames->finish(); !ok) return ok;
  }
  return impl_->write_run(state, reason, utc(now));
}

}  // namespace graspd::record
