/// The log odds that a pose is right, fitted to refined poses of simulated tuning frames: `kOdds`
/// of server/perception/src/pose_hypothesis.cpp.
///
/// Frame k of a part has the seed `seed + k`; tuning seeds start at 1000. A pose is right where its
/// MSSD to a true object is below a tenth of the diameter.
#include <fmt/format.h>

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <iostream>
#include <numeric>
#include <stdexcept>

#include "graspd/command_line/progress.hpp"
#include "graspd/command_line/run_program.hpp"
#include "graspd/eval/evaluate.hpp"
#include "graspd/eval/pose_error.hpp"
#include "graspd/formats/table.hpp"
#include "graspd/perception/explanation.hpp"
#include "graspd/perception/hypotheses.hpp"
#include "graspd/perception/preprocess.hpp"
#include "piles.hpp"

namespace graspd::bench {
namespace {

constexpr std::array kCameraHeights_m{0.7, 0.9};
constexpr double kRightShare = 0.1;  ///< of the diameter
constexpr int kNewtonSteps = 30;

struct Options {
  std::filesystem::path parts = "deploy/parts";
  int frames_n = 5;
  std::uint64_t seed = 1000;
};

/// 1, and the terms of PoseVerifier::confidence.
using Terms = Eigen::Matrix<double, 5, 1>;
constexpr std::array kTermNames{"at_zero", "fit", "refuted", "log_support", "leftover"};

struct Sample {
  Terms terms;
  bool is_right = false;
  double score = 0;  ///< what poses are ranked by without the fit
};

bool is_right(const parts::Part& part, const Eigen::Isometry3d& T_camera_part,
              const std::vector<BopTruth>& truth) {
  const double right_m = kRightShare * part.diameter_m;
  return std::ranges::any_of(truth, [&](const BopTruth& one) {
    const double off_m =
        (T_camera_part * part.barycentre_m - one.T_camera_part * part.barycentre_m).norm();
    return off_m <= right_m && eval::mssd_m(part, T_camera_part, one.T_camera_part) <= right_m;
  });
}

/// Every pose that the search finds in a frame and that is worth refining, refined, where no other
/// rule refuses it.
void add_samples(const BopImage& image, const parts::Part& part, const PlanRequest& request,
                 const perception::Parameters& parameters, std::vector<Sample>& samples) {
  const perception::Scene scene =
      perception::prepare_scene(image.frame, request, part.diameter_m, parameters);
  const std::array parts{&part};
  const perception::PoseVerifier verifier(*scene.grid, parts, parameters.registration);
  auto found =
      perception::find_hypotheses(*scene.grid, verifier, parts, parameters.registration).poses;
  perception::keep_promising(*scene.grid, verifier, parameters.registration, found);
  for (perception::PoseHypothesis& pose : found) {
    if (verifier.refine(pose)) continue;
    const perception::ConfidenceTerms terms =
        verifier.confidence_terms(pose, verifier.leftover_share(pose));
    Sample& sample = samples.emplace_back();
    sample.terms << 1, terms.fit, terms.refuted, terms.log_support, terms.leftover;
    sample.is_right = is_right(part, pose.T_camera_part(), image.truth);
    sample.score = static_cast<double>(pose.score);
  }
}

std::vector<Sample> samples_of(const parts::Catalogue& catalogue, const parts::Part& part,
                               const Options& options, Progress& progress) {
  perception::Parameters parameters;
  parameters.registration.min_confidence = 0;  // it would choose by what is to be fitted
  std::vector<Sample> samples;
  for (const double height_m : kCameraHeights_m) {
    simulation::SceneOptions scene = pile_of(part, 45, height_m);
    scene.seed = options.seed;
    parameters.preprocess.wall_bow_m = scene.sensor.wall_bow_m;  // not found: no one asks for it
    const auto maker = simulation::SceneMaker::create(catalogue, scene);
    if (!maker) throw std::runtime_error(maker.error().message);
    for (int k = 0; k < options.frames_n; ++k) {
      const auto image = maker->make(k);
      if (!image) throw std::runtime_error(image.error().message);
      add_samples(*image, part, eval::request_for(*image, catalogue, {part.id}), parameters,
                  samples);
      progress.step();
    }
  }
  return samples;
}

/// Logistic regression by Newton's method.
Terms fit(const std::vector<Sample>& samples) {
  Terms weights = Terms::Zero();
  for (int step = 0; step < kNewtonSteps; ++step) {
    Eigen::Matrix<double, 5, 5> hessian = 1e-6 * Eigen::Matrix<double, 5, 5>::Identity();
    Terms gradient = Terms::Zero();
    for (const Sample& sample : samples) {
      const double probability = 1 / (1 + std::exp(-weights.dot(sample.terms)));
      gradient += (double(sample.is_right) - probability) * sample.terms;
      hessian += probability * (1 - probability) * sample.terms * sample.terms.transpose();
    }
    weights += hessian.ldlt().solve(gradient);
  }
  return weights;
}

/// How often a right pose comes before a wrong one.
template <class Value>
double auc(const std::vector<Sample>& samples, Value value) {
  std::vector<std::pair<double, bool>> ranked;
  for (const Sample& sample : samples) ranked.emplace_back(value(sample), sample.is_right);
  std::sort(ranked.begin(), ranked.end());
  double wrong_n = 0, before_n = 0;
  for (const auto& [_, is_right] : ranked) {
    if (is_right) {
      before_n += wrong_n;
    } else {
      ++wrong_n;
    }
  }
  const double right_n = static_cast<double>(ranked.size()) - wrong_n;
  return before_n / std::max(1.0, right_n * wrong_n);
}

void run(const Options& options) {
  const auto catalogue = parts::Catalogue::load(options.parts);
  if (!catalogue) throw std::runtime_error(catalogue.error().message);
  const std::size_t frames_n =
      catalogue->parts().size() * kCameraHeights_m.size() * std::size_t(options.frames_n);
  Progress progress("refining poses", frames_n);
  std::vector<std::vector<Sample>> by_part;
  for (const parts::Part& part : catalogue->parts()) {
    by_part.push_back(samples_of(*catalogue, part, options, progress));
  }

  Table table({"part", "poses", "right", "AUC of the score", "AUC, fitted on the other parts"});
  std::vector<Sample> all;
  for (std::size_t p = 0; p < by_part.size(); ++p) {
    std::vector<Sample> others;
    for (std::size_t q = 0; q < by_part.size(); ++q) {
      if (q != p) others.insert(others.end(), by_part[q].begin(), by_part[q].end());
    }
    const Terms weights = fit(others);
    const std::vector<Sample>& own = by_part[p];
    table.add({catalogue->parts()[p].id, std::to_string(own.size()),
               std::to_string(std::ranges::count_if(own, &Sample::is_right)),
               fmt::format("{:.3f}", auc(own, [](const Sample& one) { return one.score; })),
               fmt::format("{:.3f}",
                           auc(own, [&](const Sample& one) { return weights.dot(one.terms); }))});
    all.insert(all.end(), own.begin(), own.end());
  }
  std::cout << table.to_markdown() << "\n";
  const Terms weights = fit(all);
  Table constants({"term", "log odds"});
  for (std::size_t i = 0; i < kTermNames.size(); ++i) {
    constants.add({kTermNames[i], fmt::format("{:.3f}", weights[Eigen::Index(i)])});
  }
  std::cout << constants.to_markdown();
}

}  // namespace
}  // namespace graspd::bench

int main(int count, char** words) {
  graspd::bench::Options options;
  return graspd::run_program("bench_confidence", count, words, [&](CLI::App& app) {
    app.description("Fits how probable a pose is, by what the image says of it.");
    app.add_option("--parts", options.parts, "part catalogue")->capture_default_str();
    app.add_option("--frames", options.frames_n, "of each part and camera height")
        ->check(CLI::PositiveNumber)
        ->capture_default_str();
    app.add_option("--seed", options.seed, "of the first frame; tuning seeds start at 1000")
        ->capture_default_str();
    app.callback([&] { graspd::bench::run(options); });
  });
}
