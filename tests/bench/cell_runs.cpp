#include "cell_runs.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <ctime>
#include <optional>
#include <utility>

#include "graspd/agent/averaging_camera.hpp"
#include "graspd/agent/pick_cycle.hpp"
#include "graspd/eval/pose_error.hpp"
#include "graspd/simulated/film.hpp"
#include "simulated_equipment.hpp"

namespace graspd::bench {
namespace {

/// An arm that was stopped by what it met is set going again, so often in one bin.
constexpr int kMaxResets = 10;
constexpr int kMaxPicksPerPart = 3;

/// Of this thread, which the cell's physics and sensor run on: work beside the bench does not
/// count.
double cpu_s() {
  std::timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + static_cast<double>(now.tv_nsec) * 1e-9;
}

double seconds(std::chrono::nanoseconds duration) {
  return std::chrono::duration<double>(duration).count();
}

agent::Task task_of(const BinJob& job) {
  agent::Task task;
  task.request.T_base_camera = *job.cell.T_base_camera;
  task.request.bin = job.cell.bin;
  task.request.parts = {{job.part.id}};
  task.request.gripper = job.cell.gripper;
  task.request.options = job.pipeline.plan;
  task.T_base_place = job.cell.T_base_place;
  task.failed_spot_radius_m = job.cell.failed_spot_radius_m;
  task.retry = job.cell.retry;
  task.reactions = job.cell.reactions;
  task.stir = job.cell.stir;
  return task;
}

/// Knows which part the agent means, and waits for the trace of each pick.
class Judge final : public agent::Observer {
 public:
  Judge(const sim_cell::PhysicsCell& cell, const parts::Part& part) : cell_(cell), part_(part) {}

  void planned(std::uint64_t, const DepthFrame&, const PlanRequest&,
               const Result<PlanAnswer>& answer) override {
    objects_ = answer ? answer->objects : std::vector<Object>();
    parts_ = cell_.parts();
  }
  void finished(const agent::PickRecord& record) override {
    planning_s += seconds(record.plan);
    if (!record.chosen) return;
    open_ = Open{seconds(record.plan), {}, record.chosen->grasp};
    for (const Object& object : objects_) {
      if (object.id != record.chosen->grasp.object_id) continue;
      open_->intended = cell_.part_at(0, object.T_base_part);
      open_->score = object.score;
    }
  }
  /// To be called when the next frame was taken. \returns the pick before it, if there was one.
  std::optional<PickRow> judged() {
    if (!open_) return std::nullopt;
    const sim_cell::JudgedPick judged = sim_cell::judge(cell_.last_trace(), open_->intended);
    PickRow row{++picks_n,         std::string(name_of(judged.verdict)),
                judged.why,        judged.others_moved_m,
                open_->planning_s, 0,
                open_->score,      open_->grasp.room_m};
    if (!row.why.empty()) {
      if (open_->intended) row.why += fmt::format("; {}", known_of(*open_->intended));
      for (const sim_cell::Touch& touch : cell_.last_trace().touches) {
        if (!touch.part || touch.part == open_->intended || !touch.is_before_closing) continue;
        row.why += fmt::format(", {}", known_of(*touch.part));
      }
      row.why += "; " + place_of(open_->grasp);
    }
    open_.reset();
    return row;
  }

  int picks_n = 0;
  double planning_s = 0;

 private:
  struct Open {
    double planning_s = 0;
    std::optional<std::size_t> intended;
    Grasp grasp;
    double score = 0;
  };

  /// What the plan's objects say of a part: by how much the nearest one's pose is off.
  std::string known_of(std::size_t part) const {
    double least_m = part_.diameter_m / 2;
    const Eigen::Vector3d p_mm =
        1e3 * (cell_.options().bin.T_base_bin.inverse() * parts_[part].T_base_part).translation();
    std::string known = fmt::format("part {} at ({:.0f} {:.0f} {:.0f}) mm not found", part,
                                    p_mm.x(), p_mm.y(), p_mm.z());
    for (const Object& object : objects_) {
      const double error_m = eval::mssd_m(part_, object.T_base_part, parts_[part].T_base_part);
      if (error_m >= least_m) continue;
      least_m = error_m;
      known = fmt::format("part {} found {:.1f} mm off", part, 1e3 * error_m);
    }
    return known;
  }

  /// Where in the bin.
  std::string place_of(const Grasp& grasp) const {
    const Eigen::Isometry3d T_bin_grasp =
        cell_.options().bin.T_base_bin.inverse() * grasp.T_base_grasp;
    const Eigen::Vector3d p_mm = 1e3 * T_bin_grasp.translation();
    const double tilt_rad = std::acos(std::clamp(-T_bin_grasp(2, 2), -1.0, 1.0));
    return fmt::format(
        "{} at ({:.0f} {:.0f} {:.0f}) mm in the bin, tilted by {:.0f}°, {:.0f} mm open",
        grasp.pick_point, p_mm.x(), p_mm.y(), p_mm.z(), tilt_rad * 180 / M_PI,
        1e3 * grasp.opening_width_m);
  }

  const sim_cell::PhysicsCell& cell_;
  const parts::Part& part_;
  std::vector<Object> objects_;
  std::vector<sim_cell::CellPart> parts_;  ///< as they lay when it was planned
  std::optional<Open> open_;
};

}  // namespace

std::vector<Pipeline> all_pipelines() {
  const auto made = [](std::string name, Segmentation segmentation, Registration registration,
                       GraspOrder order = GraspOrder::kDescending) {
    PlanOptions plan;
    plan.segmentation = segmentation;
    plan.registration = registration;
    plan.order = order;
    return Pipeline{std::move(name), plan};
  };
  using S = Segmentation;
  using R = Registration;
  return {made("euclidean_sac_ia", S::kEuclidean, R::kSacIaIcp),
          made("euclidean_ndt", S::kEuclidean, R::kNdtIcp),
          made("region_growing_sac_ia", S::kRegionGrowing, R::kSacIaIcp),
          made("region_growing_ndt", S::kRegionGrowing, R::kNdtIcp),
          made("paper", S::kImprovedDbscan, R::kPcaIcp),
          made("paper_ascending", S::kImprovedDbscan, R::kPcaIcp, GraspOrder::kAscending),
          made("verified", S::kGridDbscan, R::kVerified),
          made("verified_ascending", S::kGridDbscan, R::kVerified, GraspOrder::kAscending)};
}

Result<BinRow> empty_bin(const BinJob& job, const simulation::PileMaker& piles,
                         agent::Planner& planner,
                         const std::function<void(const PickRow&)>& on_pick) {
  const auto wall_start = std::chrono::steady_clock::now();
  const auto pile = piles.drop({static_cast<int>(job.cell.arm.pile->count_n)},
                               job.cell.bin->inner_size_m, job.cell.arm.pile->seed);
  if (!pile) return tl::unexpected(pile.error());
  const std::vector<parts::Mesh> kinds{job.part.mesh};
  const auto made =
      agent::SimCell::create(kinds, *pile, robot_agent::layout(job.cell), job.carrier);
  if (!made) return tl::unexpected(made.error());
  agent::SimCell& cell = **made;
  agent::AveragingCamera camera({std::shared_ptr<void>(), &cell.camera()},
                                job.cell.averaged_frames_n);
  const agent::Ports ports{camera, cell.timed(planner), cell.arm(), cell.gripper(), cell.clock()};
  std::optional<agent::Film> film;
  if (job.gif) film.emplace(cell.physics(), std::vector{job.part.color_rgb});
  Judge judge(cell.physics(), job.part);

  double lap_s = cpu_s();
  const auto report = [&] {
    auto row = judge.judged();
    if (!row) return;
    row->cpu_s = cpu_s() - std::exchange(lap_s, cpu_s());
    on_pick(*row);
  };
  BinRow bin;
  bin.parts_n = static_cast<int>(pile->parts.size());
  for (int resets_n = 0;; ++resets_n) {
    bin.resets_n = resets_n;
    const int stalls_n = cell.physics().stalls_n();
    agent::PickCycle cycle(ports, task_of(job), judge);
    while (!cycle.is_over()) {
      const agent::State before = cycle.state();
      cycle.step();
      if (before == agent::State::kAcquire) report();
      if (judge.picks_n >= kMaxPicksPerPart * bin.parts_n) cycle.finish();
    }
    bin.reason = cycle.reason();
    cell.physics().frame();
    report();
    // An operator would set the arm going again.
    const bool is_stalled = cell.physics().stalls_n() > stalls_n;
    if (!is_stalled || cycle.state() != agent::State::kStopped || resets_n == kMaxResets) break;
  }
  for (const sim_cell::CellPart& one : cell.physics().parts()) bin.placed_n += one.is_placed;
  bin.duration_s = seconds(cell.clock().now());
  bin.planning_s = judge.planning_s;
  bin.wall_s = seconds(std::chrono::steady_clock::now() - wall_start);
  if (film) {
    if (auto ok = film->write(*job.gif); !ok) return tl::unexpected(ok.error());
  }
  return bin;
}

}  // namespace graspd::bench
