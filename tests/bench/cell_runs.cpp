#include "cell_runs.hpp"

#include <chrono>
#include <ctime>
#include <optional>
#include <utility>

#include "graspd/agent/pick_cycle.hpp"
#include "graspd/sim_cell/scene.hpp"
#include "graspd/simulated/sim_cell.hpp"

namespace graspd::bench {
namespace {

/// An arm that was stopped by what it met is set going again, so often in one bin.
constexpr int kMaxResets = 10;
constexpr int kMaxPicksPerPart = 3;
constexpr double kCameraHeight_m = 0.75;

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

Eigen::Isometry3d pointing_down(const Eigen::Vector3d& p_m) {
  return Eigen::Translation3d(p_m) * Eigen::AngleAxisd(M_PI, Eigen::Vector3d::UnitX());
}

/// The bin's longer side lies across the arm's reach.
sim_cell::PhysicsCellOptions layout(int seed) {
  sim_cell::PhysicsCellOptions cell;
  cell.bin.inner_size_m = {0.30, 0.24, 0.12};
  cell.bin.wall_thickness_m = 0.005;
  cell.bin.T_base_bin =
      Eigen::Translation3d(0.30, 0, 0) * Eigen::AngleAxisd(M_PI / 2, Eigen::Vector3d::UnitZ());
  cell.place.inner_size_m = {0.20, 0.20, 0.06};
  cell.place.wall_thickness_m = 0.005;
  cell.place.T_base_bin.translation() << 0, -0.33, 0;
  cell.T_base_camera = cell.bin.T_base_bin * sim_cell::camera_over_bin(kCameraHeight_m, 0);
  // Fingers long enough to reach the floor along a wall while the palm stays above the rim.
  cell.gripper.jaw_size_m = {0.008, 0.016, 0.09};
  cell.gripper.palm_size_m = {0.10, 0.06, 0.05};
  cell.seed = static_cast<std::uint64_t>(seed) << 16;
  return cell;
}

agent::Task task_of(const parts::Part& part, const Pipeline& pipeline,
                    const sim_cell::PhysicsCellOptions& cell) {
  agent::Task task;
  task.request.T_base_camera = cell.T_base_camera;
  task.request.bin = cell.bin;
  task.request.parts = {{part.id}};
  task.request.gripper = cell.gripper;
  task.request.options = pipeline.plan;
  task.T_base_place = pointing_down(cell.place.T_base_bin * Eigen::Vector3d(0, 0, 0.07));
  return task;
}

/// The floating gripper stands in for the arm: what drives the gripper is said here and in `ports`
/// below, nowhere else.
agent::SimCell make_cell(const std::vector<parts::Mesh>& kinds, const sim_cell::Pile& pile,
                         sim_cell::PhysicsCellOptions options) {
  agent::FloatingOptions floating;
  floating.T_base_out_of_view = pointing_down({0, -0.33, 0.30});
  options.start.T_base_grasp = floating.T_base_out_of_view;
  return {kinds, pile, std::move(options), std::nullopt, floating};
}

/// An operator would set the arm going again.
bool is_stopped_by_resistance(const agent::PickCycle& cycle) {
  return cycle.state() == agent::State::kStopped &&
         cycle.reason().find("resistance") != std::string::npos;
}

/// Knows which part the agent means, and waits for the trace of each pick.
class Judge final : public agent::Observer {
 public:
  explicit Judge(const sim_cell::PhysicsCell& cell) : cell_(cell) {}

  void planned(std::uint64_t, const DepthFrame&, const PlanRequest&,
               const Result<PlanAnswer>& answer) override {
    objects_ = answer ? answer->objects : std::vector<Object>{};
  }
  void finished(const agent::PickRecord& record) override {
    planning_s += seconds(record.plan);
    if (!record.chosen) return;
    Open open{seconds(record.plan), {}};
    for (const Object& object : objects_) {
      if (object.id != record.chosen->grasp.object_id) continue;
      open.intended = cell_.part_at(0, object.T_base_part);
    }
    open_ = open;
  }
  /// To be called when the next frame was taken. \returns the pick before it, if there was one.
  std::optional<PickRow> judged() {
    if (!open_) return std::nullopt;
    const sim_cell::JudgedPick judged = sim_cell::judge(cell_.last_trace(), open_->intended);
    PickRow row{++picks_n, std::string(name_of(judged.verdict)), judged.why, judged.others_moved_m,
                open_->planning_s};
    open_.reset();
    return row;
  }

  int picks_n = 0;
  double planning_s = 0;

 private:
  struct Open {
    double planning_s = 0;
    std::optional<std::size_t> intended;
  };

  const sim_cell::PhysicsCell& cell_;
  std::vector<Object> objects_;
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

Result<BinRow> empty_bin(const parts::Part& part, int parts_n, const Pipeline& pipeline, int seed,
                         const sim_cell::PileMaker& piles, agent::Planner& planner,
                         const std::function<void(const PickRow&)>& on_pick) {
  const auto wall_start = std::chrono::steady_clock::now();
  const sim_cell::PhysicsCellOptions options = layout(seed);
  const auto pile = piles.drop({parts_n}, options.bin.inner_size_m, std::uint64_t(seed));
  if (!pile) return tl::unexpected(pile.error());
  const std::vector<parts::Mesh> kinds{part.mesh};
  agent::SimCell cell = make_cell(kinds, *pile, options);
  const agent::Ports ports{cell.camera(), cell.timed(planner), cell.floating_arm(), cell.gripper(),
                           cell.clock()};
  Judge judge(cell.physics());

  double lap_s = cpu_s();
  const auto report = [&] {
    auto row = judge.judged();
    if (!row) return;
    row->cpu_s = cpu_s() - std::exchange(lap_s, cpu_s());
    on_pick(*row);
  };
  BinRow bin;
  bin.parts_n = static_cast<int>(pile->parts.size());
  for (int resets_n = 0; resets_n <= kMaxResets; ++resets_n) {
    agent::PickCycle cycle(ports, task_of(part, pipeline, options), judge);
    while (!cycle.is_over()) {
      const agent::State before = cycle.state();
      cycle.step();
      if (before == agent::State::kAcquire) report();
      if (judge.picks_n >= kMaxPicksPerPart * bin.parts_n) cycle.finish();
    }
    bin.reason = cycle.reason();
    cell.physics().frame();
    report();
    if (!is_stopped_by_resistance(cycle)) break;
  }
  for (const sim_cell::CellPart& one : cell.physics().parts()) bin.placed_n += one.is_taken_away;
  bin.duration_s = seconds(cell.clock().now());
  bin.planning_s = judge.planning_s;
  bin.wall_s = seconds(std::chrono::steady_clock::now() - wall_start);
  return bin;
}

}  // namespace graspd::bench
