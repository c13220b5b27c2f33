/// The pile graph, P_system and the ranking, against what physics says of simulated piles: who
/// bears whom, and what moves when a part is lifted straight up.
///
/// Piles of one part and mixed ones of all parts take turns; pile k has the seed `seed + k`.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <fstream>
#include <iostream>
#include <nlohmann/json.hpp>
#include <random>

#include "graspd/command_line/progress.hpp"
#include "graspd/command_line/run_program.hpp"
#include "graspd/eval/quantile.hpp"
#include "graspd/formats/table.hpp"
#include "graspd/parts/catalogue.hpp"
#include "graspd/perception/grs.hpp"
#include "pile_measures.hpp"
#include "pile_objects.hpp"
#include "ranking.hpp"

namespace graspd::bench {
namespace {

using perception::PlacedPart;

const Eigen::Vector3d kBin_m(0.30, 0.24, 0.12);
constexpr int kParts = 45;
constexpr double kDisturbed_m = 0.01;
constexpr std::array kErrors_m{0.0, 0.001, 0.002};
constexpr std::array kOverlapDistances_m{0.001, 0.002, 0.004};
constexpr std::size_t kFirstRanks = 5;

struct Options {
  std::filesystem::path parts = "deploy/parts";
  std::string out = "build/bench/pile";
  int piles_n = 8;
  int seed = 1;
};

/// Every point of the part is off by about so much.
PlacedPart with_error(PlacedPart placed, double error_m, std::mt19937& random) {
  std::normal_distribution<double> normal(0, error_m / std::sqrt(3));
  const auto any = [&] {
    const double x = normal(random);
    const double y = normal(random);
    return Eigen::Vector3d(x, y, normal(random));
  };
  const Eigen::Vector3d barycentre_m = placed.barycentre_m();
  const Eigen::Vector3d shift_m = any();
  const Eigen::Vector3d turn_rad = any() / placed.part->radius_m;
  if (error_m == 0) return placed;
  placed.T_floor_part = Eigen::Translation3d(barycentre_m + shift_m) *
                        Eigen::AngleAxisd(turn_rad.norm(), turn_rad.normalized()) *
                        Eigen::Translation3d(-barycentre_m) * placed.T_floor_part;
  return placed;
}

/// What is said of piles whose poses are known, but for an error.
struct OfPoses {
  Agreement edges, supporting;
  Separation graph_rests, graph_disturbs;
  std::map<double, Separation> count_rests, count_disturbs;  ///< by overlap distance
  std::vector<double> graph_ms, count_ms;

  void add(const PileTruth& truth, const std::vector<PlacedPart>& parts) {
    const auto start = std::chrono::steady_clock::now();
    const perception::PileGraph graph = perception::make_pile_graph(parts, {});
    graph_ms.push_back(milliseconds_since(start));
    for (std::size_t i = 0; i < parts.size(); ++i) {
      const bool disturbs = truth.disturbance_m(i) > kDisturbed_m;
      const double burden = 1 - perception::p_system_support(graph.load[i], graph.cover[i]);
      supporting.add(!graph.supports[i].empty(), truth.is_supporting(i));
      graph_rests.add(burden, truth.is_supporting(i));
      graph_disturbs.add(burden, disturbs);
      for (std::size_t j = 0; j < parts.size(); ++j) {
        if (i == j) continue;
        const bool said = std::ranges::binary_search(graph.lies_on[i], j);
        edges.add(said, truth.lies_on(i, j));
      }
    }
    for (const double distance_m : kOverlapDistances_m) add_count(truth, parts, distance_m);
  }

 private:
  static double milliseconds_since(std::chrono::steady_clock::time_point start) {
    return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start)
        .count();
  }
  void add_count(const PileTruth& truth, const std::vector<PlacedPart>& parts, double distance_m) {
    perception::GrsParameters parameters;
    parameters.overlap_distance_m = distance_m;
    const auto start = std::chrono::steady_clock::now();
    std::vector<double> counts;
    for (std::size_t i = 0; i < parts.size(); ++i) {
      counts.push_back(perception::p_system_count(i, parts, parameters).points_n);
    }
    if (distance_m == kOverlapDistances_m.front()) count_ms.push_back(milliseconds_since(start));
    for (std::size_t i = 0; i < parts.size(); ++i) {
      count_rests[distance_m].add(counts[i], truth.is_supporting(i));
      count_disturbs[distance_m].add(counts[i], truth.disturbance_m(i) > kDisturbed_m);
    }
  }
};

/// A way to rank, and what became of what it ranked first.
struct Ranking {
  std::string name;
  perception::Parameters parameters;
  int piles_n = 0, disturbs_n = 0, takes_along_n = 0;
  int first_ranks_n = 0, first_ranks_disturb_n = 0;

  void add(const std::vector<PlacedPart>& parts, const PileTruth& truth) {
    std::vector<Object> objects(parts.size());
    std::vector<Grasp> grasps(parts.size());
    for (std::uint32_t i = 0; i < parts.size(); ++i) objects[i].id = grasps[i].object_id = i;
    perception::describe_pile(parts, parameters, objects);
    perception::rank_grasps({}, parameters, objects, grasps);
    ++piles_n;
    disturbs_n += truth.disturbance_m(grasps[0].object_id) > kDisturbed_m;
    takes_along_n += truth.takes_along(grasps[0].object_id);
    for (std::size_t rank = 0; rank < std::min(kFirstRanks, grasps.size()); ++rank) {
      ++first_ranks_n;
      first_ranks_disturb_n += truth.disturbance_m(grasps[rank].object_id) > kDisturbed_m;
    }
  }
};

std::vector<Ranking> rankings() {
  std::vector<Ranking> all;
  for (const PSystem p_system : {PSystem::kCount, PSystem::kSupport}) {
    for (const GraspOrder order : {GraspOrder::kDescending, GraspOrder::kAscending}) {
      Ranking ranking{fmt::format("{}, {}", name_of(p_system), name_of(order)), {}};
      ranking.parameters.grs.p_system = p_system;
      ranking.parameters.grs.order = order;
      all.push_back(ranking);
    }
  }
  return all;
}

struct Measured {
  std::map<double, OfPoses> of_poses;  ///< by their error
  std::vector<Ranking> rankings = bench::rankings();
};

void add(const PileTruth& truth, std::mt19937& random, Measured& measured) {
  for (const double error_m : kErrors_m) {
    std::vector<PlacedPart> parts;
    for (const PlacedPart& part : truth.parts()) parts.push_back(with_error(part, error_m, random));
    measured.of_poses[error_m].add(truth, parts);
    for (Ranking& ranking : measured.rankings) ranking.add(parts, truth);
  }
}

Result<Measured> measure(const parts::Catalogue& catalogue, const Options& options) {
  std::vector<const parts::Part*> kinds;
  std::vector<parts::Mesh> meshes;
  for (const parts::Part& part : catalogue.parts()) {
    kinds.push_back(&part);
    meshes.push_back(part.mesh);
  }
  const simulation::PileMaker maker(meshes);
  const simulation::PilePhysics physics(meshes);
  const auto kinds_n = static_cast<int>(kinds.size());
  Measured measured;
  std::mt19937 random(1);
  Progress progress("piles", static_cast<std::size_t>(options.piles_n));
  for (int k = 0; k < options.piles_n; ++k) {
    // One kind after the other, and between them all kinds together.
    std::vector<int> counts(kinds.size(), kParts / kinds_n);
    if (k % 2 == 0) {
      counts.assign(kinds.size(), 0);
      counts[static_cast<std::size_t>((k / 2) % kinds_n)] = kParts;
    }
    const auto pile = maker.drop(counts, kBin_m, static_cast<std::uint64_t>(options.seed + k));
    if (!pile) return tl::unexpected(pile.error());
    add(PileTruth(*pile, kBin_m, kinds, physics), random, measured);
    progress.step();
  }
  return measured;
}

std::string share(double value) { return fmt::format("{:.2f}", value); }

void report_poses(const std::map<double, OfPoses>& of_poses, nlohmann::json& figures) {
  Table graph({"pose error", "edges: precision", "recall", "supporting parts: precision", "recall",
               "AUC of P_system: something rests on it", "its lift disturbs another", "graph ms",
               "count ms"});
  Table counts({"pose error", "coincide within", "AUC: something rests on it",
                "its lift disturbs another", "best threshold", "its hits", "its false alarms",
                "false alarms at 15"});
  for (const auto& [error_m, said] : of_poses) {
    const std::string error = fmt::format("{:.0f} mm", error_m * 1e3);
    graph.add({error, share(said.edges.precision()), share(said.edges.recall()),
               share(said.supporting.precision()), share(said.supporting.recall()),
               share(said.graph_rests.auc()), share(said.graph_disturbs.auc()),
               share(eval::quantile(said.graph_ms, 0.5)),
               share(eval::quantile(said.count_ms, 0.5))});
    for (const auto& [distance_m, rests] : said.count_rests) {
      const auto best = rests.best();
      counts.add({error, fmt::format("{:.0f} mm", distance_m * 1e3), share(rests.auc()),
                  share(said.count_disturbs.at(distance_m).auc()), fmt::format("{}", best.value),
                  share(best.hit_rate), share(best.false_alarm_rate),
                  share(rests.at(15).false_alarm_rate)});
    }
    auto& json = figures[error];
    json = {{"edge_precision", said.edges.precision()},
            {"edge_recall", said.edges.recall()},
            {"supporting_precision", said.supporting.precision()},
            {"supporting_recall", said.supporting.recall()},
            {"support_auc_rests", said.graph_rests.auc()},
            {"support_auc_disturbs", said.graph_disturbs.auc()},
            {"graph_ms", eval::quantile(said.graph_ms, 0.5)}};
  }
  std::cout << graph.to_markdown() << "\n" << counts.to_markdown() << "\n";
}

void report_rankings(const std::vector<Ranking>& rankings, nlohmann::json& figures) {
  Table table({"P_system, order", "the first's lift disturbs another", "takes another along",
               "of the first five: disturb another"});
  for (const Ranking& ranking : rankings) {
    const double piles_n = std::max(1, ranking.piles_n);
    const double disturbs = ranking.disturbs_n / piles_n;
    const double takes_along = ranking.takes_along_n / piles_n;
    const double of_five =
        double(ranking.first_ranks_disturb_n) / std::max(1, ranking.first_ranks_n);
    table.add({ranking.name, share(disturbs), share(takes_along), share(of_five)});
    figures[ranking.name] = {{"first_disturbs", disturbs},
                             {"first_takes_along", takes_along},
                             {"first_five_disturb", of_five}};
  }
  std::cout << table.to_markdown();
}

Result<void> run(const Options& options) {
  const auto catalogue = parts::Catalogue::load(options.parts);
  if (!catalogue) return tl::unexpected(catalogue.error());
  const auto measured = measure(*catalogue, options);
  if (!measured) return tl::unexpected(measured.error());
  nlohmann::json figures;
  report_poses(measured->of_poses, figures);
  report_rankings(measured->rankings, figures);
  std::ofstream file(options.out + ".json");
  file << figures.dump(2) << "\n" << std::flush;
  if (!file) return invalid("{}.json: can't be written; is its folder there?", options.out);
  return {};
}

}  // namespace
}  // namespace graspd::bench

int main(int count, char** words) {
  graspd::bench::Options options;
  return graspd::run_program("bench_pile", count, words, [&](CLI::App& app) {
    app.description("Pile graph, P_system and ranking against physics, on simulated piles.");
    app.add_option("--parts", options.parts, "part catalogue")->capture_default_str();
    app.add_option("--piles", options.piles_n, "piles")
        ->check(CLI::PositiveNumber)
        ->capture_default_str();
    app.add_option("--seed", options.seed, "of the first pile")->capture_default_str();
    app.add_option("--out", options.out, "where to write, without the file's extension")
        ->capture_default_str();
    app.callback([&] {
      if (auto ok = graspd::bench::run(options); !ok) throw std::runtime_error(ok.error().message);
    });
  });
}
