#include "graspd/eval/command.hpp"

#include <fmt/format.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <cmath>
#include <iostream>
#include <memory>

#include "graspd/command_line/choices.hpp"
#include "graspd/command_line/help.hpp"
#include "graspd/command_line/progress.hpp"
#include "graspd/command_line/run_program.hpp"
#include "graspd/eval/evaluate.hpp"
#include "graspd/eval/mesh_part.hpp"
#include "graspd/eval/quantile.hpp"
#include "graspd/formats/table.hpp"
#include "graspd/parts/catalogue.hpp"
#include "graspd/service/config.hpp"

namespace graspd::eval {
namespace {

constexpr double kMillimetre_m = 1e-3;
constexpr double kDegree_rad = M_PI / 180;

struct Options {
  std::filesystem::path scene;
  std::filesystem::path out;
  std::filesystem::path config;
  std::filesystem::path parts;
  std::filesystem::path mesh;
  std::string mesh_unit = "mm";
  std::vector<std::string> part_ids;
  std::string segmentation;
  std::string registration;
  int threads_n = 1;
};

/// The catalogue, or the one part that --mesh makes. Its BOP number is the scene's first.
Result<parts::Catalogue> load_parts(const Options& options, const BopScene& scene) {
  if (options.mesh.empty()) return parts::Catalogue::load(options.parts);
  const auto first = scene.read(scene.image_ids().front());
  if (!first) return tl::unexpected(first.error());
  auto part = mesh_part(options.mesh, *parse_enum<parts::LengthUnit>(options.mesh_unit),
                        first->truth.empty() ? 1 : first->truth.front().obj_id);
  if (!part) return tl::unexpected(part.error());
  std::vector<parts::Part> parts;
  parts.push_back(*std::move(part));
  return parts::Catalogue(std::move(parts));
}

Result<perception::Parameters> load_parameters(const Options& options) {
  perception::Parameters parameters;
  if (!options.config.empty()) {
    const auto config = service::read_config(options.config);
    if (!config) return tl::unexpected(config.error());
    parameters = config->perception;
  }
  if (const auto method = parse_enum<Segmentation>(options.segmentation)) {
    parameters.segmentation.method = *method;
  }
  if (const auto method = parse_enum<Registration>(options.registration)) {
    parameters.registration.method = *method;
  }
  return parameters;
}

std::vector<std::string> row_of(const ImageReport& report) {
  const Funnel& funnel = report.answer.funnel;
  const auto share = [](bool known, double value) {
    return known ? fmt::format("{:.2f}", value) : std::string("–");
  };
  return {std::to_string(report.im_id),
          std::string(name_of(report.answer.outcome)),
          std::to_string(funnel.after_plane_n),
          std::to_string(funnel.segments_n),
          std::to_string(funnel.registered_n),
          std::to_string(funnel.grasps_n),
          share(report.segmentation.has_value(),
                report.segmentation ? report.segmentation->accuracy() : 0),
          share(report.poses.has_value(), report.poses ? report.poses->recall() : 0),
          share(report.poses.has_value(), report.poses ? report.poses->precision() : 0),
          fmt::format("{:.1f}", report.time_s * 1e3)};
}

std::string to_text(const std::optional<Spread>& error, double unit) {
  if (!error) return "–";
  return fmt::format("{:.2f} ({:.2f})", error->median / unit, error->p90 / unit);
}

void print_poses(const PoseAccuracy& poses) {
  fmt::print(
      "poses: {} of {} objects visible by half or more found (recall {:.3f}), {} of {} answers "
      "right (precision {:.3f}), AP {:.3f}; right is MSSD below 0.1 diameters\n"
      "errors of the right answers, median (90th percentile):\n\n",
      poses.found_n(), poses.objects_n(), poses.recall(), poses.right_n(), poses.answers_n(),
      poses.precision(), poses.average_precision());
  Table table({"visible", "objects", "found", "recall", "error mm", "error deg"});
  const auto add = [&](const std::string& visible, const PoseAccuracy& accuracy) {
    table.add({visible, std::to_string(accuracy.objects_n()), std::to_string(accuracy.found_n()),
               accuracy.objects.empty() ? "–" : fmt::format("{:.3f}", accuracy.recall()),
               to_text(accuracy.translation_error_m(), kMillimetre_m),
               to_text(accuracy.rotation_error_rad(), kDegree_rad)});
  };
  for (const VisibilityBin& bin : poses.by_visibility()) {
    add(fmt::format("{:.1f} to {:.1f}", bin.from, bin.to), bin.accuracy);
  }
  add("all", poses);
  std::cout << table.to_text();
}

void print_totals(const std::vector<ImageReport>& reports) {
  SegmentationAccuracy segmentation;
  PoseAccuracy poses;
  bool has_segmentation = false;
  bool has_poses = false;
  std::vector<double> times_s;
  for (const ImageReport& report : reports) {
    times_s.push_back(report.time_s);
    if (report.segmentation) segmentation += *report.segmentation;
    if (report.poses) poses += *report.poses;
    has_segmentation |= report.segmentation.has_value();
    has_poses |= report.poses.has_value();
  }
  fmt::print("\nmedian time: {:.1f} ms a frame, loading excluded\n", quantile(times_s, 0.5) * 1e3);
  if (has_segmentation) {
    fmt::print(
        "segmentation: {} of {} objects visible by half or more found at IoU 0.5 ({:.1f} %), {} "
        "over-segmented, {} segments hold several objects, {:.1f} % of the points kept\n",
        segmentation.found_n, segmentation.objects_n, segmentation.accuracy() * 100,
        segmentation.over_segmented_n, segmentation.under_segmented_n, segmentation.kept() * 100);
  }
  if (has_poses) print_poses(poses);
}

Result<void> check_parts(const Options& options, const parts::Catalogue& catalogue) {
  for (const std::string& id : options.part_ids) {
    if (const auto part = catalogue.get(id); !part) return tl::unexpected(part.error());
  }
  return {};
}

Result<void> run(const Options& options) {
  const auto scene = BopScene::open(options.scene);
  if (!scene) return tl::unexpected(scene.error());
  const auto catalogue = load_parts(options, *scene);
  if (!catalogue) return tl::unexpected(catalogue.error());
  if (auto ok = check_parts(options, *catalogue); !ok) return ok;
  const auto parameters = load_parameters(options);
  if (!parameters) return tl::unexpected(parameters.error());
  const tbb::global_control threads(tbb::global_control::max_allowed_parallelism,
                                    static_cast<std::size_t>(options.threads_n));

  std::vector<ImageReport> reports;
  std::vector<BopResult> results;
  Table table({"image", "outcome", "points", "segments", "parts", "grasps", "segmentation",
               "recall", "precision", "ms"});
  Progress progress("evaluating", scene->image_ids().size());
  for (const int im_id : scene->image_ids()) {
    const auto image = scene->read(im_id);
    if (!image) return tl::unexpected(image.error());
    const PlanRequest request = request_for(*image, *catalogue, options.part_ids);
    auto report = evaluate_image(*image, scene->scene_id(), request, *catalogue, *parameters);
    if (!report) {
      return fail(report.error().code, "image {}: {}", im_id, report.error().message);
    }
    table.add(row_of(*report));
    results.insert(results.end(), report->results.begin(), report->results.end());
    reports.push_back(*std::move(report));
    progress.step();
  }
  progress.hide();
  std::cout << table.to_text();
  print_totals(reports);
  if (options.out.empty()) return {};
  fmt::print("results: {}\n", options.out.string());
  return write_bop_results(options.out, results);
}

}  // namespace

void add_eval_command(CLI::App& app) {
  CLI::App* command =
      app.add_subcommand("eval", "run the pipeline on a BOP scene folder, without a network");
  set_help(*command,
           "Says how many parts were found where the true poses are known. The results file is "
           "what the BOP benchmark's own tools read.",
           {"grasp_server eval build/piles --parts deploy/parts --out build/results.csv"});
  auto options = std::make_shared<Options>();
  command->add_option("scene", options->scene, "folder with scene_camera.json and depth/")
      ->required();
  command->add_option("--out", options->out, "write BOP results CSV here");
  command->add_option("--config", options->config, "server configuration, for its parameters");
  auto* parts = command->add_option("--parts", options->parts, "part catalogue folder");
  auto* mesh =
      command->add_option("--mesh", options->mesh, "look for this mesh alone")->excludes(parts);
  command->add_option("--mesh-unit", options->mesh_unit, "the mesh's unit")
      ->capture_default_str()
      ->check(one_of<parts::LengthUnit>())
      ->needs(mesh);
  command->add_option("--part", options->part_ids,
                      "look for this part; may be repeated (default: those in scene_gt.json)");
  command->add_option("--segmentation", options->segmentation, "segmentation method")
      ->check(one_of<Segmentation>());
  command->add_option("--registration", options->registration, "registration method")
      ->check(one_of<Registration>());
  command->add_option("--threads", options->threads_n, "threads of one frame")
      ->capture_default_str()
      ->check(CLI::Range(1, 256));
  command->callback([options] {
    if (options->mesh.empty() && options->parts.empty()) {
      throw CLI::RequiredError("--parts DIR or --mesh FILE");
    }
    if (auto ok = run(*options); !ok) {
      const Error& error = ok.error();
      std::cerr << fmt::format("grasp_server: {}: {}\n", name_of(error.code), error.message);
      throw CLI::RuntimeError(error.code == Code::kInternal ? kExitFailed : kExitWrongInput);
    }
  });
}

}  // namespace graspd::eval
