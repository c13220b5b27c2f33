/// Table II: a robot agent empties bins in physics, planning at a grasp server over the network.
///
/// Each pipeline gets the same piles: pile k of a part has the seed `seed + k`. Tuning seeds start
/// at 1000.
#include <fmt/format.h>

#include <fstream>
#include <iostream>

#include "cell_report.hpp"
#include "driven_arm.hpp"
#include "graspd/command_line/progress.hpp"
#include "graspd/command_line/run_program.hpp"
#include "graspd/perception/planner.hpp"
#include "graspd/server_planner/server_planner.hpp"

namespace graspd::bench {
namespace {

constexpr std::chrono::seconds kBudget{60};

struct Options {
  std::filesystem::path parts = "deploy/parts";
  std::string out = "build/bench/cell";
  std::string commit;
  std::filesystem::path cell = "deploy/cells/simulated_tees.yaml";
  bool floating = false;
  std::string gif;
  std::string server;
  std::vector<std::string> part_ids, pipelines;
  int tee_piles_n = 20, other_piles_n = 10;
  int piles_n = 0;
  int parts_n = 30;
  int seed = 1;
  bool fresh = false;
};

/// Perception without a server between, for quick looks.
class InProcessPlanner final : public agent::Planner {
 public:
  explicit InProcessPlanner(const parts::Catalogue& catalogue) : catalogue_(catalogue) {}
  agent::PlanReply plan(const DepthFrame& frame, const PlanRequest& request) override {
    return {"", perception::plan(frame, request, catalogue_, parameters_)};
  }

 private:
  const parts::Catalogue& catalogue_;
  perception::Parameters parameters_;
};

Result<std::unique_ptr<agent::Planner>> make_planner(const Options& options,
                                                     const parts::Catalogue& catalogue) {
  if (options.server.empty()) return std::make_unique<InProcessPlanner>(catalogue);
  return agent::connect_planner({options.server}, "bench", kBudget);
}

Result<robot_agent::CellConfig> read_cell(const Options& options) {
  auto cell = robot_agent::read_cell_config(options.cell, ".");
  if (cell && !cell->arm.pile) {
    return invalid("--cell: {} is not simulated", options.cell.string());
  }
  return cell;
}

Result<Carrier> make_carrier(const robot_agent::CellConfig& cell, bool floating) {
  const auto arm = robot_agent::load_arm(cell);
  if (!arm) return tl::unexpected(arm.error());
  if (!floating) return *arm;
  return agent::FloatingOptions{.T_base_out_of_view =
                                    arm->model.T_base_flange(arm->out_of_view_rad) *
                                    arm->parameters.T_flange_grasp};
}

/// Those named, in the order of the list; all where none is named.
template <class T, class Name>
Result<std::vector<T>> chosen(std::vector<T> all, const std::vector<std::string>& names,
                              const char* what, Name name) {
  std::vector<T> found;
  for (const std::string& wanted : names) {
    const auto one = std::ranges::find(all, wanted, name);
    if (one == all.end()) return invalid("{}: no '{}'", what, wanted);
    found.push_back(*one);
  }
  return names.empty() ? std::move(all) : found;
}

Result<void> run_part(const parts::Part& part, const std::vector<Pipeline>& pipelines,
                      const Options& options, robot_agent::CellConfig cell, const Carrier& carrier,
                      agent::Planner& planner, CellLog& log) {
  const simulation::PileMaker piles({part.mesh});
  const int piles_n = options.piles_n > 0 ? options.piles_n
                      : part.id == "tee"  ? options.tee_piles_n
                                          : options.other_piles_n;
  cell.arm.pile->count_n = static_cast<std::uint32_t>(options.parts_n);
  for (int k = 0; k < piles_n; ++k) {
    cell.arm.pile->seed = static_cast<std::uint32_t>(options.seed + k);
    for (const Pipeline& pipeline : pipelines) {
      const BinKey key{pipeline.name, part.id, options.seed + k};
      if (log.has(key)) continue;
      BinJob job{part, pipeline, cell, carrier, std::nullopt};
      if (!options.gif.empty()) job.gif = options.gif;
      const std::string what =
          fmt::format("{} {} pile {} of {}", part.id, pipeline.name, k + 1, piles_n);
      Progress placed(what + ": placed", static_cast<std::size_t>(options.parts_n));
      auto bin = empty_bin(job, piles, planner, [&](const PickRow& pick) {
        log.add(key, pick);
        if (pick.verdict == "SUCCESS") placed.step();
      });
      if (!bin) return tl::unexpected(bin.error());
      bin->commit = options.commit;
      log.add(key, *bin);
      placed.hide();
      std::cerr << fmt::format("{}: {} of {} parts placed in {:.0f} s: {}\n", what, bin->placed_n,
                               bin->parts_n, bin->wall_s, bin->reason);
    }
  }
  return {};
}

Result<void> run(const Options& options) {
  const auto catalogue = parts::Catalogue::load(options.parts);
  if (!catalogue) return tl::unexpected(catalogue.error());
  std::vector<const parts::Part*> all;
  for (const parts::Part& part : catalogue->parts()) all.push_back(&part);
  const auto parts =
      chosen(all, options.part_ids, "--part", [](const parts::Part* part) { return part->id; });
  const auto pipelines = chosen(all_pipelines(), options.pipelines, "--pipeline", &Pipeline::name);
  const auto cell = read_cell(options);
  if (!cell) return tl::unexpected(cell.error());
  const auto carrier = make_carrier(*cell, options.floating);
  auto planner = make_planner(options, *catalogue);
  if (!parts) return tl::unexpected(parts.error());
  if (!pipelines) return tl::unexpected(pipelines.error());
  if (!carrier) return tl::unexpected(carrier.error());
  if (!planner) return tl::unexpected(planner.error());

  CellLog log(options.out, options.fresh);
  for (const parts::Part* part : *parts) {
    if (auto ok = run_part(*part, *pipelines, options, *cell, *carrier, **planner, log); !ok) {
      return ok;
    }
  }
  std::cout << cell_table(log.results()).to_markdown();
  std::ofstream file(options.out + ".json");
  file << cell_figures(log.results()).dump(2) << "\n" << std::flush;
  if (!file) return invalid("{}.json: can't be written", options.out);
  return {};
}

}  // namespace
}  // namespace graspd::bench

int main(int count, char** words) {
  graspd::bench::Options options;
  return graspd::run_program("bench_cell", count, words, [&](CLI::App& app) {
    app.description("Table II: an agent empties bins in physics.");
    app.add_option("--parts", options.parts, "part catalogue")->capture_default_str();
    app.add_option("--server", options.server,
                   "a grasp server's data endpoint; without it perception runs in this process");
    app.add_option("--cell", options.cell, "configuration of a simulated cell")
        ->capture_default_str();
    app.add_flag("--floating", options.floating, "no arm: the gripper gets anywhere");
    app.add_option("--part", options.part_ids, "by id; all without it");
    app.add_option("--pipeline", options.pipelines, "by name; all without it");
    app.add_option("--piles", options.piles_n, "of each part; without it 20 of tees, 10 of others");
    app.add_option("--parts-n", options.parts_n, "in a bin")->capture_default_str();
    app.add_option("--seed", options.seed, "of the first pile; from 1000 on for tuning")
        ->check(CLI::PositiveNumber)
        ->capture_default_str();
    app.add_option("--gif", options.gif,
                   "an animation of a bin's emptying; of several bins, the last one's");
    app.add_flag("--fresh", options.fresh, "forget what earlier runs have measured");
    app.add_option("--out", options.out, "stem of the files that are written")
        ->take_last()
        ->capture_default_str();
    app.add_option("--commit", options.commit, "of the sources, for each bin's row");
    app.callback([&] {
      if (auto ok = graspd::bench::run(options); !ok) throw std::runtime_error(ok.error().message);
    });
  });
}
