/// The memory of a worker process of a grasp server that runs, over many frames.
///
/// Light frames, a few parts in the bin, and every so many a heavy one: a pile of one kind of part,
/// or of all, asked for together. The same frames come again and again, so that what grows is not
/// what is looked at.
#include <fmt/format.h>

#include <chrono>
#include <fstream>
#include <iostream>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "graspd/client/client.hpp"
#include "graspd/command_line/progress.hpp"
#include "graspd/command_line/run_program.hpp"
#include "graspd/eval/evaluate.hpp"
#include "graspd/formats/table.hpp"
#include "piles.hpp"
#include "slope.hpp"

namespace graspd::bench {
namespace {

constexpr int kLightFrames = 4;  ///< of each part
constexpr int kHeavyFrames = 2;
constexpr std::chrono::seconds kBudget{60};

struct Options {
  std::filesystem::path parts = "deploy/parts";
  std::filesystem::path out = "build/bench";
  std::string server;
  int worker_pid = 0;
  int frames_n = 10000;
  int heavy_every_n = 10;
  int sample_every_n = 50;
  int heavy_parts_n = 45;
  int light_parts_n = 5;
};

struct Question {
  DepthFrame frame;
  PlanRequest request;
};

/// \throws std::runtime_error where the process is gone: a worker that was replaced proves nothing.
double resident_mb(int pid) {
  std::ifstream status(fmt::format("/proc/{}/status", pid));
  for (std::string word; status >> word;) {
    double kibibytes = 0;
    if (word == "VmRSS:" && status >> kibibytes) return kibibytes * 1024e-6;
  }
  throw std::runtime_error(fmt::format("process {}: has ended, or is no worker of ours", pid));
}

void add_questions(const simulation::SceneOptions& scene, int frames_n,
                   const parts::Catalogue& catalogue, std::vector<Question>& questions) {
  const auto maker = simulation::SceneMaker::create(catalogue, scene);
  if (!maker) throw std::runtime_error(maker.error().message);
  std::vector<std::string> ids;
  for (const simulation::PartCount& kind : scene.parts) ids.push_back(kind.part_id);
  for (int k = 0; k < frames_n; ++k) {
    auto image = maker->make(k);
    if (!image) throw std::runtime_error(image.error().message);
    const PlanRequest request = eval::request_for(*image, catalogue, ids);
    questions.push_back({std::move(image->frame), request});
  }
}

struct Questions {
  std::vector<Question> light;
  std::vector<Question> heavy;
};

Questions make_questions(const Options& options) {
  const auto catalogue = parts::Catalogue::load(options.parts);
  if (!catalogue) throw std::runtime_error(catalogue.error().message);
  Questions questions;
  simulation::SceneOptions mixed;
  const auto kinds_n = static_cast<int>(catalogue->parts().size());
  for (const parts::Part& part : catalogue->parts()) {
    add_questions(pile_of(part, options.light_parts_n), kLightFrames, *catalogue, questions.light);
    add_questions(pile_of(part, options.heavy_parts_n), kHeavyFrames, *catalogue, questions.heavy);
    mixed.parts.push_back({part.id, options.heavy_parts_n / kinds_n});
  }
  add_questions(mixed, kHeavyFrames, *catalogue, questions.heavy);
  return questions;
}

/// What is still growing in the second half of the samples.
double growth_mb_per_1000_frames(const std::vector<Eigen::Vector2d>& samples) {
  const auto half = static_cast<std::ptrdiff_t>(samples.size() / 2);
  return slope({samples.begin() + half, samples.end()}) * 1000;
}

void run(const Options& options) {
  const Questions questions = make_questions(options);
  client::Client client({options.server});
  const double loaded_mb = resident_mb(options.worker_pid);
  std::vector<Eigen::Vector2d> samples;  // frame, MB
  std::size_t light = 0;
  std::size_t heavy = 0;
  Progress progress("frames", static_cast<std::size_t>(options.frames_n));
  for (int k = 1; k <= options.frames_n; ++k) {
    const bool is_heavy = k % options.heavy_every_n == 0;
    const Question& question = is_heavy ? questions.heavy[heavy++ % questions.heavy.size()]
                                        : questions.light[light++ % questions.light.size()];
    const auto answer = client.plan(question.frame, question.request, kBudget);
    if (!answer) throw std::runtime_error(answer.error().message);
    progress.step();
    if (k % options.sample_every_n != 0) continue;
    samples.emplace_back(k, resident_mb(options.worker_pid));
  }
  progress.hide();
  if (samples.empty()) throw std::invalid_argument("--frames: fewer than one sample's");

  Table raw({"frame", "rss_mb"});
  double most_mb = loaded_mb;
  double start_mb = loaded_mb;
  const auto round_n = static_cast<int>(questions.heavy.size()) * options.heavy_every_n;
  raw.add({"0", fmt::format("{:.2f}", loaded_mb)});
  for (const Eigen::Vector2d& sample : samples) {
    raw.add({fmt::format("{:.0f}", sample.x()), fmt::format("{:.2f}", sample.y())});
    most_mb = std::max(most_mb, sample.y());
    if (sample.x() <= round_n) start_mb = sample.y();
  }
  const double growth_mb = growth_mb_per_1000_frames(samples);
  Table table({"worker's memory", "MB"});
  table.add({"parts loaded, no frame yet", fmt::format("{:.1f}", loaded_mb)});
  table.add({"every frame seen once", fmt::format("{:.1f}", start_mb)});
  table.add({fmt::format("after {} frames", options.frames_n),
             fmt::format("{:.1f}", samples.back().y())});
  table.add({"most", fmt::format("{:.1f}", most_mb)});
  table.add({"growth in 1,000 frames, second half", fmt::format("{:.2f}", growth_mb)});
  std::cout << table.to_markdown();
  const nlohmann::json figures{
      {"worker_rss_mb_loaded", loaded_mb},          {"worker_rss_mb_start", start_mb},
      {"worker_rss_mb_end", samples.back().y()},    {"worker_rss_mb_max", most_mb},
      {"worker_rss_mb_per_1000_frames", growth_mb}, {"frames", options.frames_n}};
  std::ofstream(options.out / "memory.csv") << raw.to_csv();
  std::ofstream(options.out / "memory.json") << figures.dump(2) << "\n";
}

}  // namespace
}  // namespace graspd::bench

int main(int count, char** words) {
  graspd::bench::Options options;
  return graspd::run_program("bench_memory", count, words, [&](CLI::App& app) {
    app.description("The memory of a running server's worker, over many frames.");
    app.add_option("--server", options.server, "data endpoint")->required();
    app.add_option("--worker", options.worker_pid, "process id of the server's only worker")
        ->required();
    app.add_option("--parts", options.parts, "the server's part catalogue")->capture_default_str();
    app.add_option("--out", options.out, "folder for memory.json and memory.csv")
        ->capture_default_str();
    app.add_option("--frames", options.frames_n, "to plan")
        ->check(CLI::PositiveNumber)
        ->capture_default_str();
    app.add_option("--heavy-every", options.heavy_every_n, "of which each so many is heavy")
        ->check(CLI::PositiveNumber)
        ->capture_default_str();
    app.callback([&] { graspd::bench::run(options); });
  });
}
