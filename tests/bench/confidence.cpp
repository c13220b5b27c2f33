/// The log odds that a pose is right, fitted to poses in simulated tuning frames: the constants of
/// server/perception/src/confidence.cpp. First those of a pose alone, in bins that hold nothing but
/// the part that is asked for; then, given these, those of a part that was found in a bin that may
/// hold others, or only others.
///
/// Frame k of a bin has the seed `seed + k`; tuning seeds start at 1000. A pose is right where its
/// MSSD to a true object is below a tenth of the diameter.
#include <fmt/format.h>

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <iostream>
#include <stdexcept>

#include "graspd/command_line/progress.hpp"
#include "graspd/command_line/run_program.hpp"
#include "graspd/eval/evaluate.hpp"
#include "graspd/eval/pose_error.hpp"
#include "graspd/formats/table.hpp"
#include "graspd/perception/explanation.hpp"
#include "graspd/perception/hypotheses.hpp"
#include "graspd/perception/organised.hpp"
#include "graspd/perception/preprocess.hpp"
#include "graspd/perception/segmentation.hpp"
#include "graspd/perception/verified.hpp"
#include "logistic_regression.hpp"
#include "piles.hpp"

namespace graspd::bench {
namespace {

constexpr std::array kCameraHeights_m{0.7, 0.9};
constexpr double kRightShare = 0.1;  ///< of the diameter

struct Options {
  std::filesystem::path parts = "deploy/parts";
  int frames_n = 5;
  std::uint64_t seed = 1000;
};

/// What lies in a bin: so many of the part that is asked for, and of each other one.
struct Bin {
  const char* name;
  int asked_n, of_others_n;
};
constexpr std::array kBins{Bin{"45 asked for", 45, 0}, Bin{"5 asked for", 5, 0},
                           Bin{"10 among 35 others", 10, 7}, Bin{"45 others", 0, 9},
                           Bin{"5 others", 0, 1}};

bool is_right(const parts::Part& part, const Eigen::Isometry3d& T_camera_part,
              const std::vector<BopTruth>& truth) {
  const double right_m = kRightShare * part.diameter_m;
  return std::ranges::any_of(truth, [&](const BopTruth& one) {
    if (one.obj_id != part.bop_obj_id) return false;
    const double off_m =
        (T_camera_part * part.barycentre_m - one.T_camera_part * part.barycentre_m).norm();
    return off_m <= right_m && eval::mssd_m(part, T_camera_part, one.T_camera_part) <= right_m;
  });
}

/// A bin's image, and what the search needs of it.
class Frame {
 public:
  Frame(const BopImage& image, const parts::Part& part, const parts::Catalogue& catalogue,
        const perception::Parameters& parameters)
      : image_(image),
        part_(part),
        registration_(parameters.registration),
        scene_(perception::prepare_scene(image.frame,
                                         eval::request_for(image, catalogue, {part.id}),
                                         part.diameter_m, parameters)) {
    const auto segments =
        perception::segment(scene_.cloud, parts_, parameters.preprocess, parameters.segmentation);
    perception::drop_islands_without_segments(segments, scene_);
  }

  /// Every pose that is worth refining, refined, where no rule refuses it.
  void add_poses(std::vector<Sample>& samples, std::vector<double>& scores) {
    auto found = search();
    perception::keep_promising(*scene_.grid, verifier_, registration_, found);
    for (perception::PoseHypothesis& pose : found) {
      if (verifier_.refine(pose)) continue;
      const perception::ConfidenceTerms terms =
          verifier_.confidence_terms(pose, verifier_.leftover_share(pose));
      Sample& sample = samples.emplace_back();
      sample.terms =
          Eigen::VectorXd{{1, terms.fit, terms.refuted, terms.log_support, terms.leftover}};
      sample.is_right = is_right(part_, pose.T_camera_part(), image_.truth);
      scores.push_back(static_cast<double>(pose.score));
    }
  }

  /// Every part that is found, as it would be answered if none were too improbable.
  void add_parts(std::vector<Sample>& samples) {
    perception::Explanation explanation;
    for (int look = 0; look < perception::kLooks; ++look) {
      perception::explain(*scene_.grid, verifier_, scene_, search(), registration_,
                          perception::never_late, explanation);
    }
    const auto terms = perception::terms_in_bin(*scene_.grid, verifier_, explanation);
    for (std::size_t i = 0; i < terms.size(); ++i) {
      const auto& [alone, share, leftover] = terms[i];
      const float explained = std::min(1.0F, share / perception::kExplainedEnough);
      Sample& sample = samples.emplace_back();
      sample.terms = Eigen::VectorXd{
          {1, std::log(alone / (1 - alone)), explained, (1 - explained) * leftover}};
      sample.is_right = is_right(part_, explanation.parts[i].pose.T_camera_part(), image_.truth);
    }
  }

 private:
  std::vector<perception::PoseHypothesis> search() const {
    return perception::find_hypotheses(*scene_.grid, verifier_, parts_, registration_).poses;
  }

  const BopImage& image_;
  const parts::Part& part_;
  const perception::RegistrationParameters& registration_;
  perception::Scene scene_;
  const std::array<const parts::Part*, 1> parts_{&part_};
  const perception::PoseVerifier verifier_{*scene_.grid, parts_, registration_};
};

/// Calls `visit(frame)` for each frame of a bin.
template <class Visit>
void for_frames(const parts::Catalogue& catalogue, const parts::Part& part, const Bin& bin,
                const Options& options, Progress& progress, Visit visit) {
  perception::Parameters parameters;
  parameters.registration.min_confidence = 0;  // it would choose by what is to be fitted
  for (const double height_m : kCameraHeights_m) {
    simulation::SceneOptions scene = pile_of(part, bin.asked_n, height_m);
    if (bin.asked_n == 0) scene.parts.clear();
    for (const parts::Part& other : catalogue.parts()) {
      if (&other != &part && bin.of_others_n > 0)
        scene.parts.push_back({other.id, bin.of_others_n});
    }
    scene.seed = options.seed;
    parameters.preprocess.wall_bow_m = scene.sensor.wall_bow_m;  // not found: no one asks for it
    const auto maker = simulation::SceneMaker::create(catalogue, scene);
    if (!maker) throw std::runtime_error(maker.error().message);
    for (int k = 0; k < options.frames_n; ++k) {
      const auto image = maker->make(k);
      if (!image) throw std::runtime_error(image.error().message);
      Frame frame(*image, part, catalogue, parameters);
      visit(frame);
      progress.step();
    }
  }
}

std::size_t frames_of_bin(const parts::Catalogue& catalogue, const Options& options) {
  return catalogue.parts().size() * kCameraHeights_m.size() * std::size_t(options.frames_n);
}

void print_weights(std::initializer_list<const char*> names, const Eigen::VectorXd& weights) {
  Table constants({"term", "log odds"});
  Eigen::Index i = 0;
  for (const char* name : names) constants.add({name, fmt::format("{:.3f}", weights[i++])});
  std::cout << constants.to_markdown() << "\n";
}

std::vector<double> log_odds(const std::vector<Sample>& samples, const Eigen::VectorXd& weights) {
  std::vector<double> values;
  for (const Sample& sample : samples) values.push_back(weights.dot(sample.terms));
  return values;
}

struct OfPart {
  std::vector<Sample> samples;
  std::vector<double> scores;  ///< what poses are ranked by without the fit
};

void fit_alone(const parts::Catalogue& catalogue, const Options& options) {
  Progress progress("poses alone", frames_of_bin(catalogue, options));
  std::vector<OfPart> by_part;
  for (const parts::Part& part : catalogue.parts()) {
    OfPart& own = by_part.emplace_back();
    for_frames(catalogue, part, kBins.front(), options, progress,
               [&](Frame& frame) { frame.add_poses(own.samples, own.scores); });
  }
  Table table({"part", "poses", "right", "AUC of the score", "AUC, fitted on the other parts"});
  std::vector<Sample> all;
  for (std::size_t p = 0; p < by_part.size(); ++p) {
    std::vector<Sample> others;
    for (std::size_t q = 0; q < by_part.size(); ++q) {
      const auto& samples = by_part[q].samples;
      if (q != p) others.insert(others.end(), samples.begin(), samples.end());
    }
    const auto& [own, scores] = by_part[p];
    table.add({catalogue.parts()[p].id, std::to_string(own.size()),
               std::to_string(std::ranges::count_if(own, &Sample::is_right)),
               fmt::format("{:.3f}", auc(own, scores)),
               fmt::format("{:.3f}", auc(own, log_odds(own, fit_log_odds(others))))});
    all.insert(all.end(), own.begin(), own.end());
  }
  std::cout << table.to_markdown() << "\n";
  print_weights({"at_zero", "fit", "refuted", "log_support", "leftover"}, fit_log_odds(all));
}

/// How many answers there are, and how many of them are right, where at least `min` is asked of
/// their probability.
std::string answers_above(double min, const std::vector<Sample>& samples,
                          const std::vector<double>& log_odds) {
  int answers_n = 0, right_n = 0;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    if (1 / (1 + std::exp(-log_odds[i])) < min) continue;
    ++answers_n;
    right_n += samples[i].is_right;
  }
  return fmt::format("{} of {}", right_n, answers_n);
}

void fit_in_bin(const parts::Catalogue& catalogue, const Options& options) {
  Progress progress("parts found in bins", kBins.size() * frames_of_bin(catalogue, options));
  std::vector<std::vector<Sample>> by_bin;
  std::vector<Sample> all;
  for (const Bin& bin : kBins) {
    std::vector<Sample>& own = by_bin.emplace_back();
    for (const parts::Part& part : catalogue.parts()) {
      for_frames(catalogue, part, bin, options, progress,
                 [&](Frame& frame) { frame.add_parts(own); });
    }
    all.insert(all.end(), own.begin(), own.end());
  }
  const Eigen::VectorXd weights = fit_log_odds(all);
  const double min = perception::RegistrationParameters{}.min_confidence;
  Table table({"bin", "frames", "found", "right", "alone: right of answers",
               "in the bin: right of answers"});
  const Eigen::VectorXd as_alone{{0, 1, 0, 0}};
  for (std::size_t b = 0; b < kBins.size(); ++b) {
    const std::vector<Sample>& own = by_bin[b];
    const std::vector<double> alone = log_odds(own, as_alone);
    std::vector<double> least = log_odds(own, weights);  // both must reach the minimum
    std::ranges::transform(least, alone, least.begin(),
                           [](double one, double other) { return std::min(one, other); });
    table.add({kBins[b].name, std::to_string(frames_of_bin(catalogue, options)),
               std::to_string(own.size()),
               std::to_string(std::ranges::count_if(own, &Sample::is_right)),
               answers_above(min, own, alone), answers_above(min, own, least)});
  }
  std::cout << table.to_markdown() << "\n";
  print_weights({"at_zero", "alone", "explained", "leftover"}, weights);
}

void run(const Options& options) {
  const auto catalogue = parts::Catalogue::load(options.parts);
  if (!catalogue) throw std::runtime_error(catalogue.error().message);
  fit_alone(*catalogue, options);
  fit_in_bin(*catalogue, options);
}

}  // namespace
}  // namespace graspd::bench

int main(int count, char** words) {
  graspd::bench::Options options;
  return graspd::run_program("bench_confidence", count, words, [&](CLI::App& app) {
    app.description("Fits how probable a pose is, by what the image and the bin say of it.");
    app.add_option("--parts", options.parts, "part catalogue")->capture_default_str();
    app.add_option("--frames", options.frames_n, "of each bin, part and camera height")
        ->check(CLI::PositiveNumber)
        ->capture_default_str();
    app.add_option("--seed", options.seed, "of the first frame; tuning seeds start at 1000")
        ->capture_default_str();
    app.callback([&] { graspd::bench::run(options); });
  });
}
