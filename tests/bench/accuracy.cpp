/// How many of the parts in simulated Kinect v2 piles are found, how many answers are right and how
/// exact they are: recall, precision, average precision, errors in millimetres and degrees.
///
/// Frame k of a part has the seed `seed + k`, one of six camera poses and one of three numbers of
/// parts; any 18 frames in a row show each pair once. Tuning seeds start at 1000.
#include <fmt/format.h>
#include <tbb/global_control.h>

#include <array>
#include <fstream>
#include <iostream>
#include <nlohmann/json.hpp>

#include "accuracy_report.hpp"
#include "graspd/command_line/progress.hpp"
#include "graspd/command_line/run_program.hpp"
#include "graspd/eval/evaluate.hpp"
#include "graspd/eval/mesh_part.hpp"
#include "graspd/simulation/scene.hpp"
#include "graspd/types/mean_frame.hpp"
#include "piles.hpp"

namespace graspd::bench {
namespace {

constexpr int kFirstTuningSeed = 1000;

constexpr std::array kCameraHeights_m{0.7, 0.8, 0.9};
constexpr std::array kCameraTilts_rad{0.0, 15 * kDegree_rad};
constexpr std::array kPartsInFrame{40, 50, 60};

struct Options {
  std::filesystem::path parts = "deploy/parts";
  std::vector<std::string> part_ids;
  std::vector<std::filesystem::path> meshes;
  std::string mesh_unit = "mm";
  bool is_mixed = false;
  bool is_absent = false;
  std::string out = "build/bench/accuracy";
  std::string registration;
  int frames_n = 12;
  int looks_n = 1;
  int seed = 1;
};

/// What lies in the bin together, and what the planner is asked to look for.
using Kinds = std::vector<const parts::Part*>;

simulation::SceneOptions scene_of(const Kinds& kinds, int k, const Options& options) {
  simulation::SceneOptions scene;
  const auto number = static_cast<std::size_t>(k);
  const std::size_t view = number % (kCameraHeights_m.size() * kCameraTilts_rad.size());
  scene.camera_height_m = kCameraHeights_m[view % kCameraHeights_m.size()];
  scene.camera_tilt_rad = kCameraTilts_rad[view / kCameraHeights_m.size()];
  const std::size_t round = number / (kCameraHeights_m.size() * kCameraTilts_rad.size());
  const int parts_n = kPartsInFrame[(round + view) % kPartsInFrame.size()];
  const auto kinds_n = static_cast<int>(kinds.size());
  const int of_each_n = (parts_n + kinds_n - 1) / kinds_n;
  for (const parts::Part* part : kinds) scene.parts.push_back({part->id, of_each_n});
  scene.looks_n = options.looks_n;
  scene.seed = static_cast<std::uint64_t>(options.seed);
  return scene;
}

/// Calls `visit(k, scene, image)` for each frame.
template <class Visit>
Result<void> for_frames(const std::string& name, const Kinds& kinds,
                        const parts::Catalogue& catalogue, const Options& options, Visit visit) {
  Progress progress(name, static_cast<std::size_t>(options.frames_n));
  for (int k = 0; k < options.frames_n; ++k) {
    const simulation::SceneOptions scene = scene_of(kinds, k, options);
    const auto maker = simulation::SceneMaker::create(catalogue, scene);
    if (!maker) return tl::unexpected(maker.error());
    auto image = maker->make(k);
    if (!image) return tl::unexpected(image.error());
    image->instance.reset();  // segments are table1's
    if (auto ok = visit(k, scene, *image); !ok) {
      return fail(ok.error().code, "frame {}: {}", k, ok.error().message);
    }
    progress.step();
  }
  return {};
}

Result<Measured> measure(const Kinds& kinds, const parts::Catalogue& catalogue,
                         const perception::Parameters& parameters, const Options& options,
                         Table& records) {
  const std::string name = kinds.size() == 1 ? kinds.front()->id : "mixed";
  std::vector<std::string> ids;
  for (const parts::Part* part : kinds) ids.push_back(part->id);
  Measured measured;
  const auto add = [&](int k, const simulation::SceneOptions& scene,
                       const BopImage& image) -> Result<void> {
    const PlanRequest request = eval::request_for(image, catalogue, ids);
    const auto report = eval::evaluate_image(image, 0, request, catalogue, parameters);
    if (!report) return tl::unexpected(report.error());
    if (report->poses) {
      add_records(*report->poses, {k, scene}, catalogue, records);
      measured.accuracy += *report->poses;
    }
    measured.times_ms.push_back(report->time_s * 1e3);
    return {};
  };
  if (auto ok = for_frames(name, kinds, catalogue, options, add); !ok) {
    return tl::unexpected(ok.error());
  }
  return measured;
}

Result<void> write_file(const std::string& path, const std::string& text) {
  std::ofstream file(path);
  file << text << std::flush;
  if (!file) return invalid("{}: can't be written; is its folder there?", path);
  return {};
}

/// Bins of all parts but one, in which that one is looked for: every answer is wrong.
Result<void> measure_absent(const Kinds& parts, const parts::Catalogue& catalogue,
                            const perception::Parameters& parameters, const Options& options) {
  Table table = absent_table();
  nlohmann::json figures;
  for (const parts::Part* absent : parts) {
    Kinds others;
    for (const parts::Part& part : catalogue.parts()) {
      if (&part != absent) others.push_back(&part);
    }
    std::vector<std::vector<double>> scores;  // of each frame's answers
    const auto add = [&](int, const simulation::SceneOptions&,
                         const BopImage& image) -> Result<void> {
      const PlanRequest request = eval::request_for(image, catalogue, {absent->id});
      const auto report = eval::evaluate_image(image, 0, request, catalogue, parameters);
      if (!report) return tl::unexpected(report.error());
      auto& of_frame = scores.emplace_back();
      for (const Object& object : report->answer.objects) of_frame.push_back(object.score);
      return {};
    };
    if (auto ok = for_frames(absent->id, others, catalogue, options, add); !ok) return ok;
    table.add(absent_row(absent->id, scores));
    add_absent_figures(absent->id, scores, figures);
  }
  std::cout << table.to_markdown();
  return write_file(options.out + ".json", figures.dump(2) + "\n");
}

Result<parts::Catalogue> load_parts(const Options& options) {
  if (options.meshes.empty()) return parts::Catalogue::load(options.parts);
  const auto unit = parse_enum<parts::LengthUnit>(options.mesh_unit);
  if (!unit) {
    return invalid("--mesh-unit {}: known are {}", options.mesh_unit,
                   names_of<parts::LengthUnit>());
  }
  std::vector<parts::Part> parts;
  for (const auto& mesh : options.meshes) {
    auto part = eval::mesh_part(mesh, *unit, static_cast<int>(parts.size()) + 1);
    if (!part) return tl::unexpected(part.error());
    parts.push_back(*std::move(part));
  }
  return parts::Catalogue(std::move(parts));
}

Result<Kinds> choose(const parts::Catalogue& catalogue, const std::vector<std::string>& ids) {
  Kinds chosen;
  for (const std::string& id : ids) {
    chosen.push_back(catalogue.find(id));
    if (chosen.back() == nullptr) return invalid("--part {}: not in the catalogue", id);
  }
  if (!ids.empty()) return chosen;
  for (const parts::Part& part : catalogue.parts()) chosen.push_back(&part);
  return chosen;
}

Result<perception::Parameters> parameters_of(const Options& options) {
  perception::Parameters parameters;
  if (options.registration.empty()) return parameters;
  const auto method = parse_enum<Registration>(options.registration);
  if (!method) {
    return invalid("--registration {}: known are {}", options.registration,
                   names_of<Registration>());
  }
  parameters.registration.method = *method;
  return parameters;
}

std::vector<Kinds> piles_of(const Kinds& parts, bool is_mixed) {
  if (is_mixed) return {parts};
  std::vector<Kinds> piles;
  for (const parts::Part* part : parts) piles.push_back({part});
  return piles;
}

/// Frames that parameters were chosen on measure nothing.
Result<void> check_seeds(const Options& options) {
  if (options.seed >= 1 && options.seed + options.frames_n <= kFirstTuningSeed) return {};
  return invalid("--seed {} with {} frames: test seeds are 1 to {}", options.seed, options.frames_n,
                 kFirstTuningSeed - 1);
}

Result<void> run(const Options& options) {
  if (auto ok = check_seeds(options); !ok) return ok;
  const auto catalogue = load_parts(options);
  if (!catalogue) return tl::unexpected(catalogue.error());
  const auto parts = choose(*catalogue, options.part_ids);
  if (!parts) return tl::unexpected(parts.error());
  const auto parameters = parameters_of(options);
  if (!parameters) return tl::unexpected(parameters.error());
  const tbb::global_control one_core(tbb::global_control::max_allowed_parallelism, 1);

  if (options.is_absent) return measure_absent(*parts, *catalogue, *parameters, options);
  Table table = accuracy_table();
  Table records = record_table();
  nlohmann::json figures;
  nlohmann::json plots;
  Measured all;
  for (const Kinds& kinds : piles_of(*parts, options.is_mixed)) {
    const auto measured = measure(kinds, *catalogue, *parameters, options, records);
    if (!measured) return tl::unexpected(measured.error());
    for (const parts::Part* part : kinds) {
      // The time of a frame with several kinds is no part's own.
      const Measured own{measured->accuracy.of_part(part->bop_obj_id),
                         kinds.size() == 1 ? measured->times_ms : std::vector<double>{}};
      table.add(row_of(part->id, own));
      add_figures(part->id, own, figures);
      plots.push_back(plot_of(*part, own.accuracy));
    }
    all.accuracy += measured->accuracy;
    all.times_ms.insert(all.times_ms.end(), measured->times_ms.begin(), measured->times_ms.end());
  }
  table.add(row_of("all", all));
  add_figures("all", all, figures);
  add_targets(*parts, figures);
  std::cout << table.to_markdown();
  if (auto ok = write_file(options.out + ".csv", records.to_csv()); !ok) return ok;
  if (auto ok = write_file(options.out + ".json", figures.dump(2) + "\n"); !ok) return ok;
  return write_file(options.out + "_plots.json", plots.dump() + "\n");
}

}  // namespace
}  // namespace graspd::bench

int main(int count, char** words) {
  graspd::bench::Options options;
  return graspd::run_program("bench_accuracy", count, words, [&](CLI::App& app) {
    app.description("Recall, precision, AP and errors of poses on simulated Kinect v2 piles.");
    auto* parts = app.add_option("--parts", options.parts, "part catalogue")->capture_default_str();
    auto* part = app.add_option("--part", options.part_ids,
                                "measure this part; may be repeated (default: all)");
    app.add_option("--mesh", options.meshes, "measure these meshes instead of a catalogue's parts")
        ->excludes(parts)
        ->excludes(part);
    app.add_option("--mesh-unit", options.mesh_unit, "of the meshes")->capture_default_str();
    app.add_flag("--mixed", options.is_mixed, "all parts together in each frame");
    app.add_flag("--absent", options.is_absent,
                 "look for each part in bins that hold all others but not this one")
        ->excludes("--mixed");
    app.add_option("--registration", options.registration,
                   "method (default: the planner's own default)");
    app.add_option("--frames", options.frames_n, "of each part, or mixed ones")
        ->check(CLI::PositiveNumber)
        ->capture_default_str();
    app.add_option("--looks", options.looks_n, "frame: the mean of so many looks at the pile")
        ->check(CLI::Range(1, static_cast<int>(graspd::kMaxMeanFrames)))
        ->capture_default_str();
    app.add_option("--seed", options.seed, "of the first frame")->capture_default_str();
    app.add_option("--out", options.out, "where to write, without the files' extensions")
        ->capture_default_str();
    app.callback([&] {
      if (auto ok = graspd::bench::run(options); !ok) throw std::runtime_error(ok.error().message);
    });
  });
}
