#include "graspd/record/recording_arm.hpp"

#include "json.hpp"

namespace graspd::record {
namespace {

Json bin_json(const Bin& bin) {
  return {{"T_base_bin", row_major(bin.T_base_bin)},
          {"inner_size_m",
           std::array{bin.inner_size_m.x(), bin.inner_size_m.y(), bin.inner_size_m.z()}}};
}

}  // namespace

Result<RecordingArm> RecordingArm::create(const std::filesystem::path& path,
                                          const CellFrames& frames) {
  auto lines = JsonLines::create(path);
  if (!lines) return tl::unexpected(lines.error());
  Json header = {{"cell", frames.cell}, {"T_base_camera", row_major(frames.T_base_camera)}};
  if (frames.bin) header["bin"] = bin_json(*frames.bin);
  if (auto ok = lines->add(to_line(header)); !ok) return tl::unexpected(ok.error());
  return RecordingArm(*std::move(lines));
}

std::optional<std::string> RecordingArm::why_not(std::span<const agent::Motion> motions) {
  const auto ok = validate(motions);
  return ok ? std::nullopt : std::optional(ok.error().message);
}

Result<void> RecordingArm::move(const agent::Motion& motion) {
  if (auto ok = validate(motion); !ok) return ok;
  last_step_ = motion.step;
  const Json line = {{"pick", pick_n_},
                     {"step", name_of(motion.step)},
                     {"path", name_of(motion.path)},
                     {"T_base_grasp", row_major(motion.T_base_grasp)}};
  return lines_.add(to_line(line));
}

Result<void> RecordingArm::move_out_of_view() {
  last_step_ = agent::Step::kOutOfView;
  const Json line = {{"pick", pick_n_}, {"step", name_of(agent::Step::kOutOfView)}};
  return lines_.add(to_line(line));
}

Result<void> RecordingArm::stop() {
  // Nothing moves, and a file that takes no more has been reported by the order before.
  static_cast<void>(lines_.add(to_line({{"pick", pick_n_}, {"step", "stop"}})));
  return {};
}

Result<void> RecordingArm::open(double opening_width_m) {
  // What was placed is let go, and what a stir has caught; else a pick begins.
  const bool lets_go = last_step_ == agent::Step::kPlace || last_step_ == agent::Step::kStirUp;
  const agent::Step step = lets_go ? agent::Step::kRelease : agent::Step::kOpen;
  closed_ = false;
  if (step == agent::Step::kOpen) ++pick_n_;
  const Json line = {
      {"pick", pick_n_}, {"step", name_of(step)}, {"opening_width_m", opening_width_m}};
  return lines_.add(to_line(line));
}

Result<void> RecordingArm::close() {
  closed_ = true;
  return lines_.add(to_line({{"pick", pick_n_}, {"step", name_of(agent::Step::kClose)}}));
}

Result<bool> RecordingArm::holds_something() { return closed_; }

}  // namespace graspd::record
