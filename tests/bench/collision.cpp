/// The collision checks of the grasp stage on simulated piles: how long they take beside FCL, and
/// how often they are right, judged by FCL from the true poses.
#include <fmt/format.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <ctime>
#include <fstream>
#include <iostream>
#include <nlohmann/json.hpp>

#include "fcl_twin.hpp"
#include "graspd/command_line/progress.hpp"
#include "graspd/command_line/run_program.hpp"
#include "graspd/eval/evaluate.hpp"
#include "graspd/eval/quantile.hpp"
#include "graspd/formats/table.hpp"
#include "graspd/perception/grasp_planning.hpp"
#include "graspd/perception/preprocess.hpp"
#include "graspd/simulation/scene.hpp"

namespace graspd {
namespace {

using perception::CollisionScene;
using perception::GraspCandidate;
using perception::PlacedPart;
using perception::SweptGripper;

struct Options {
  std::filesystem::path parts = "deploy/parts";
  std::filesystem::path out = "build/bench";
  int frames_n = 4;
  int parts_per_frame_n = 45;
  std::uint64_t seed = 5000;
};

/// What is measured on the frames of one part, or of all.
struct Measured {
  /// The grasp stage with every part of the pile registered, and what of it the candidates took.
  std::vector<double> stage_ms, candidates_ms;
  std::vector<double> cloud_us, parts_us, fcl_us;  ///< of one candidate
  int candidates_n = 0;                            ///< of the registered parts
  int twins_differ_n = 0;
  int free_n = 0;  ///< by the true poses
  int passed_cloud_n = 0, passed_parts_n = 0, passed_n = 0;
  int right_cloud_n = 0, right_parts_n = 0, right_n = 0;  ///< of these, free

  void add(const Measured& other) {
    const auto append = [](std::vector<double>& to, const std::vector<double>& from) {
      to.insert(to.end(), from.begin(), from.end());
    };
    append(stage_ms, other.stage_ms);
    append(candidates_ms, other.candidates_ms);
    append(cloud_us, other.cloud_us);
    append(parts_us, other.parts_us);
    append(fcl_us, other.fcl_us);
    for (auto count : {&Measured::candidates_n, &Measured::twins_differ_n, &Measured::free_n,
                       &Measured::passed_cloud_n, &Measured::passed_parts_n, &Measured::passed_n,
                       &Measured::right_cloud_n, &Measured::right_parts_n, &Measured::right_n}) {
      this->*count += other.*count;
    }
  }
};

double median(const std::vector<double>& values) { return eval::quantile(values, 0.5); }

/// Of this thread's own time, so that what else the machine does is not measured.
double now_us() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) * 1e6 + static_cast<double>(now.tv_nsec) * 1e-3;
}

template <class Work>
double duration_us(Work work) {
  const double start_us = now_us();
  work();
  return now_us() - start_us;
}

double opening_m(const GraspCandidate& candidate, const Gripper& gripper) {
  return std::min(candidate.width_m + 2 * gripper.clearance_m, gripper.max_opening_m);
}

/// One frame: the parts as they lie and as the plan found them, in the floor's frame.
struct Frame {
  PlanRequest request;
  perception::Scene scene;
  std::vector<PlacedPart> truth, found;
};

Result<Frame> make_frame(const BopImage& image, const parts::Catalogue& catalogue,
                         const parts::Part& part) {
  Frame frame;
  frame.request = eval::request_for(image, catalogue, {part.id});
  const auto report = eval::evaluate_image(image, 0, frame.request, catalogue, {});
  if (!report) return tl::unexpected(report.error());
  frame.scene = perception::prepare_scene(image.frame, frame.request, part.diameter_m, {});
  const Eigen::Isometry3d T_floor_camera = frame.scene.T_camera_floor.inverse();
  for (const BopTruth& truth : image.truth) {
    frame.truth.push_back({&part, T_floor_camera * truth.T_camera_part});
  }
  for (const Object& object : report->answer.objects) {
    frame.found.push_back(
        {&part, T_floor_camera * frame.request.T_base_camera.inverse() * object.T_base_part});
  }
  return frame;
}

void time_stage(const Frame& frame, Measured& measured) {
  const Gripper& gripper = frame.request.gripper;
  std::vector<std::uint32_t> ids(frame.truth.size());
  const double stage_us = duration_us([&] {
    CollisionScene scene(frame.scene, frame.truth, frame.request.bin, gripper, {});
    for (std::size_t i = 0; i < frame.truth.size(); ++i) {
      perception::plan_grasps_of(i, frame.truth, ids, gripper, {}, scene, false);
    }
  });
  const double candidates_us = duration_us([&] {
    for (std::size_t i = 0; i < frame.truth.size(); ++i) {
      perception::grasp_candidates(i, frame.truth, gripper, {});
    }
  });
  measured.stage_ms.push_back(stage_us * 1e-3);
  measured.candidates_ms.push_back(candidates_us * 1e-3);
}

bool meets_a_part(testing::FclTwin& twin, const GraspCandidate& candidate,
                  const SweptGripper& swept) {
  return std::ranges::any_of(swept.boxes(), [&](const perception::GripperBox& box) {
    return twin.meets_a_part(candidate.T_floor_grasp, box.box_m);
  });
}

/// The checks of every candidate of the parts that were found, beside FCL.
void compare(const Frame& frame, Measured& measured) {
  const Gripper& gripper = frame.request.gripper;
  const perception::CollisionParameters parameters;
  CollisionScene scene(frame.scene, frame.found, frame.request.bin, gripper, parameters);
  testing::FclTwin twin(frame.found);
  testing::FclTwin truth(frame.truth);
  const int most_n = perception::GraspParameters{}.tries_per_part_n;
  for (std::size_t i = 0; i < frame.found.size(); ++i) {
    scene.set_target(i);
    auto candidates = perception::grasp_candidates(i, frame.found, gripper, {});
    candidates.resize(std::min<std::size_t>(candidates.size(), most_n));
    for (const GraspCandidate& candidate : candidates) {
      const SweptGripper swept(gripper, opening_m(candidate, gripper));
      perception::Verdict cloud, parts;
      bool fcl_hit = false;
      measured.cloud_us.push_back(
          duration_us([&] { cloud = scene.gripper_cloud(candidate.T_floor_grasp, swept); }));
      measured.parts_us.push_back(
          duration_us([&] { parts = scene.gripper_parts(candidate.T_floor_grasp, swept); }));
      measured.fcl_us.push_back(duration_us(
          [&] { fcl_hit = twin.meets(i, candidate.T_floor_grasp, swept, parameters.margin_m); }));
      const bool in_bin = !scene.gripper_bin(candidate.T_floor_grasp, swept).failed();
      if (!in_bin) continue;
      const bool is_free = !meets_a_part(truth, candidate, swept);
      const bool passed = !cloud.failed() && !parts.failed();
      ++measured.candidates_n;
      measured.twins_differ_n += fcl_hit != parts.failed();
      measured.free_n += is_free;
      measured.passed_cloud_n += !cloud.failed();
      measured.passed_parts_n += !parts.failed();
      measured.passed_n += passed;
      measured.right_cloud_n += is_free && !cloud.failed();
      measured.right_parts_n += is_free && !parts.failed();
      measured.right_n += is_free && passed;
    }
  }
}

Result<Measured> measure(const parts::Catalogue& catalogue, const parts::Part& part,
                         const Options& options) {
  simulation::SceneOptions scene_options;
  scene_options.parts = {{part.id, options.parts_per_frame_n}};
  scene_options.seed = options.seed;
  const auto maker = simulation::SceneMaker::create(catalogue, scene_options);
  if (!maker) return tl::unexpected(maker.error());
  Measured measured;
  Progress progress(part.id, static_cast<std::size_t>(options.frames_n));
  for (int k = 0; k < options.frames_n; ++k) {
    const auto image = maker->make(k);
    if (!image) return tl::unexpected(image.error());
    const auto frame = make_frame(*image, catalogue, part);
    if (!frame) return tl::unexpected(frame.error());
    for (int again = 0; again < 3; ++again) time_stage(*frame, measured);
    compare(*frame, measured);
    progress.step();
  }
  return measured;
}

std::string percent(int share, int of) {
  return of == 0 ? "" : fmt::format("{:.1f}", 100.0 * share / of);
}

std::vector<std::string> row(const std::string& name, const Measured& m) {
  return {name,
          fmt::format("{:.2f}", median(m.stage_ms)),
          fmt::format("{:.2f}", median(m.candidates_ms)),
          fmt::format("{:.1f}", median(m.cloud_us)),
          fmt::format("{:.1f}", median(m.parts_us)),
          fmt::format("{:.1f}", median(m.fcl_us)),
          std::to_string(m.twins_differ_n),
          std::to_string(m.candidates_n),
          percent(m.free_n, m.candidates_n),
          percent(m.right_parts_n, m.passed_parts_n),
          percent(m.right_parts_n, m.free_n),
          percent(m.right_cloud_n, m.passed_cloud_n),
          percent(m.right_cloud_n, m.free_n),
          percent(m.right_n, m.passed_n),
          percent(m.right_n, m.free_n)};
}

Result<void> run(const Options& options) {
  const auto catalogue = parts::Catalogue::load(options.parts);
  if (!catalogue) return tl::unexpected(catalogue.error());
  const tbb::global_control one_core(tbb::global_control::max_allowed_parallelism, 1);
  Table table({"part", "stage ms", "of it candidates", "cloud µs", "parts µs", "FCL µs",
               "verdicts that differ", "candidates", "free %", "parts: right %", "parts: found %",
               "cloud: right %", "cloud: found %", "both: right %", "both: found %"});
  Measured all;
  for (const parts::Part& part : catalogue->parts()) {
    const auto measured = measure(*catalogue, part, options);
    if (!measured) return tl::unexpected(measured.error());
    table.add(row(part.id, *measured));
    all.add(*measured);
  }
  table.add(row("all", all));
  const nlohmann::json figures = {{"grasp_stage_ms", median(all.stage_ms)},
                                  {"candidates_ms", median(all.candidates_ms)},
                                  {"gripper_cloud_us", median(all.cloud_us)},
                                  {"gripper_parts_us", median(all.parts_us)},
                                  {"fcl_us", median(all.fcl_us)},
                                  {"verdicts_differ_n", all.twins_differ_n},
                                  {"candidates_n", all.candidates_n},
                                  {"passed_n", all.passed_n},
                                  {"passed_and_free_n", all.right_n},
                                  {"free_n", all.free_n}};
  std::cout << table.to_markdown();
  std::ofstream(options.out / "collision.json") << figures.dump(2) << "\n";
  std::ofstream(options.out / "collision.csv") << table.to_csv();
  return {};
}

}  // namespace
}  // namespace graspd

int main(int count, char** words) {
  graspd::Options options;
  return graspd::run_program("bench_collision", count, words, [&](CLI::App& app) {
    app.description("The collision checks beside FCL and against the truth.");
    app.add_option("--parts", options.parts, "part catalogue")->capture_default_str();
    app.add_option("--out", options.out, "folder for collision.json and collision.csv")
        ->capture_default_str();
    app.add_option("--frames", options.frames_n, "of each part")
        ->check(CLI::PositiveNumber)
        ->capture_default_str();
    app.add_option("--count", options.parts_per_frame_n, "parts in a frame")->capture_default_str();
    app.add_option("--seed", options.seed, "of the first frame")->capture_default_str();
    app.callback([&] {
      if (auto ok = graspd::run(options); !ok) throw std::runtime_error(ok.error().message);
    });
  });
}
