#include <fmt/format.h>

#include <cstdio>
#include <filesystem>
#include <memory>
#include <random>

#include "commands.hpp"
#include "exit_codes.hpp"
#include "graspd/command_line/help.hpp"
#include "load_recording.hpp"
#include "load_report.hpp"
#include "server_arguments.hpp"

namespace graspd::program {
namespace {

enum class PaceKind { kFixed, kPoisson, kRecorded };

}  // namespace
}  // namespace graspd::program

template <>
struct graspd::EnumNames<graspd::program::PaceKind> {
  using Kind = program::PaceKind;
  static constexpr std::string_view what = "pace";
  static constexpr std::pair<Kind, std::string_view> values[] = {
      {Kind::kFixed, "fixed"}, {Kind::kPoisson, "poisson"}, {Kind::kRecorded, "recorded"}};
};

namespace graspd::program {
namespace {

struct LoadArguments {
  std::vector<std::string> recordings;
  std::vector<std::string> servers;
  std::string server_key;
  std::string keys;
  int cells_n = 0;
  double rate_hz = 0;
  std::string pace = std::string(name_of(PaceKind::kFixed));
  int in_flight_n = 1;
  bool find_capacity = false;
  std::string encoding = std::string(name_of(DepthEncoding::kRaw));
  int budget_ms = 10'000;
  double warm_up_s = 2;
  double window_s = 5;
  int max_windows_n = 10;
  std::string out;

  PaceKind pace_kind() const { return parse_enum<PaceKind>(pace).value(); }
};

struct SimulatedCells {
  std::vector<load::Cell> cells;
  std::vector<std::vector<double>> stamps_s;  ///< of each cell
};

/// Cells are load_1, load_2, …; recordings are dealt out in turn.
Result<SimulatedCells> make_cells(const LoadArguments& arguments) {
  const auto encoding = parse_enum<DepthEncoding>(arguments.encoding).value();
  SimulatedCells simulated;
  std::vector<std::shared_ptr<const std::vector<client::PreparedPlan>>> plans;
  std::vector<std::vector<double>> stamps_s;
  for (const std::string& what : arguments.recordings) {
    auto recording = read_load_recording(what, encoding);
    if (!recording) return tl::unexpected(recording.error());
    if (!recording->note.empty()) fmt::print(stderr, "grasp: {}\n", recording->note);
    plans.push_back(
        std::make_shared<const std::vector<client::PreparedPlan>>(std::move(recording->plans)));
    stamps_s.push_back(std::move(recording->stamps_s));
  }
  const std::size_t cells_n =
      arguments.cells_n > 0 ? static_cast<std::size_t>(arguments.cells_n) : plans.size();
  for (std::size_t i = 0; i < cells_n; ++i) {
    load::Cell cell{fmt::format("load_{}", i + 1), std::nullopt, plans[i % plans.size()]};
    if (!arguments.keys.empty()) {
      const auto own = std::filesystem::path(arguments.keys) / (cell.name + ".key");
      auto keys = keys::read_client_keys(arguments.server_key, own);
      if (!keys) return tl::unexpected(keys.error());
      cell.keys = *std::move(keys);
    }
    simulated.cells.push_back(std::move(cell));
    simulated.stamps_s.push_back(stamps_s[i % plans.size()]);
  }
  return simulated;
}

double mean_frame_bytes(const std::vector<load::Cell>& cells) {
  double sum = 0;
  double frames_n = 0;
  for (const load::Cell& cell : cells) {
    for (const client::PreparedPlan& plan : *cell.plans) {
      sum += static_cast<double>(plan.payload->size());
      ++frames_n;
    }
  }
  return sum / frames_n;
}

load::OpenLoad open_load(const LoadArguments& arguments, const SimulatedCells& cells,
                         double rate_hz) {
  const std::size_t cells_n = cells.cells.size();
  const PaceKind kind = arguments.pace_kind();
  const auto pace = [=, stamps_s = cells.stamps_s](load::TimePoint start) {
    if (kind == PaceKind::kRecorded) return load::recorded_pace(start, stamps_s);
    return kind == PaceKind::kPoisson
               ? load::poisson_pace(start, rate_hz, cells_n, std::mt19937_64::default_seed)
               : load::fixed_pace(start, rate_hz, cells_n);
  };
  return {pace, kind == PaceKind::kRecorded ? 0 : rate_hz};
}

Result<int> run(const LoadArguments& arguments) {
  if (arguments.find_capacity && arguments.pace_kind() == PaceKind::kRecorded) {
    return invalid("--find-capacity tries rates, and the recorded pace has none of them");
  }
  const auto cells = make_cells(arguments);
  if (!cells) return tl::unexpected(cells.error());
  const load::GeneratorOptions generator{
      arguments.servers, std::chrono::milliseconds(arguments.budget_ms), {}};
  const load::RunOptions options{std::chrono::duration<double>(arguments.warm_up_s),
                                 std::chrono::duration<double>(arguments.window_s),
                                 arguments.max_windows_n};
  const auto run_with = [&](const load::Load& load) {
    return load::run_load(
        [&](load::Observer observer) {
          return std::make_unique<load::Generator>(cells->cells, generator, std::move(observer));
        },
        load, options,
        [](const load::Run& run) { fmt::print(stderr, "{}\n", progress_line(run)); });
  };

  LoadResult result;
  for (const load::Cell& cell : cells->cells) result.cells.push_back(cell.name);
  result.frame_bytes = mean_frame_bytes(cells->cells);
  if (arguments.find_capacity) {
    const int in_flight_n = std::max(2, arguments.in_flight_n);
    auto found = load::find_capacity(run_with(load::ClosedLoad{in_flight_n}), [&](double rate_hz) {
      return run_with(open_load(arguments, *cells, rate_hz));
    });
    result.capacity_hz = found.capacity_hz;
    result.runs.push_back(std::move(found.peak));
    std::move(found.runs.begin(), found.runs.end(), std::back_inserter(result.runs));
  } else if (arguments.rate_hz > 0 || arguments.pace_kind() == PaceKind::kRecorded) {
    result.runs.push_back(run_with(open_load(arguments, *cells, arguments.rate_hz)));
  } else {
    result.runs.push_back(run_with(load::ClosedLoad{arguments.in_flight_n}));
  }

  fmt::print("{}", load_report(result));
  for (const std::string& sentence : reservations(result)) {
    fmt::print(stderr, "grasp: {}\n", sentence);
  }
  if (!arguments.out.empty()) {
    if (auto ok = write_load(arguments.out, result); !ok) return tl::unexpected(ok.error());
    fmt::print("written   {}/load.json, load.csv, load.svg\n", arguments.out);
  }
  return result.runs.back().summary.ok_n > 0 ? 0 : kExitTryAgain;
}

void add_options(CLI::App& command, LoadArguments& arguments) {
  command
      .add_option("RECORDING[=PART]", arguments.recordings,
                  "rawlog or BOP scene, and what to ask for where it doesn't say; cells take "
                  "them in turn")
      ->required();
  add_server_option(command, arguments.servers);
  CLI::Option* server_key = command.add_option("--server-key", arguments.server_key,
                                               "the servers' public key; none: they are insecure");
  CLI::Option* keys = command.add_option("--keys", arguments.keys,
                                         "folder of the cells' keys: load_1.key, load_2.key, …");
  server_key->type_name("FILE.pub")->needs(keys);
  keys->type_name("DIR")->needs(server_key);
  command.add_option("--cells", arguments.cells_n, "how many; without it one for each recording")
      ->check(CLI::Range(1, 1000));
  CLI::Option* in_flight =
      command.add_option("--in-flight", arguments.in_flight_n, "closed loop: so many of each cell")
          ->check(CLI::Range(1, 1000))
          ->capture_default_str();
  CLI::Option* rate =
      command.add_option("--rate", arguments.rate_hz, "open loop: so many a second, of all cells")
          ->type_name("HZ")
          ->check(CLI::Range(0.01, 1e6))
          ->excludes(in_flight);
  command.add_option("--pace", arguments.pace, names_of<PaceKind>() + ", of the open loop")
      ->check([](const std::string& name) {
        return parse_enum<PaceKind>(name) ? std::string() : "known: " + names_of<PaceKind>();
      })
      ->type_name("NAME")
      ->capture_default_str();
  command
      .add_flag("--find-capacity", arguments.find_capacity,
                "the highest rate at which answers keep up, and latency up to there")
      ->excludes(rate);
  command.add_option("--encoding", arguments.encoding, names_of<DepthEncoding>())
      ->check([](const std::string& name) {
        return parse_enum<DepthEncoding>(name) ? std::string()
                                               : "known: " + names_of<DepthEncoding>();
      })
      ->type_name("NAME")
      ->capture_default_str();
  command.add_option("--budget-ms", arguments.budget_ms, "of a request, from its planned instant")
      ->check(CLI::Range(1, 3'600'000))
      ->capture_default_str();
  command.add_option("--warm-up-s", arguments.warm_up_s, "before the first window")
      ->check(CLI::Range(0.0, 3600.0))
      ->capture_default_str();
  command.add_option("--window-s", arguments.window_s, "length of a window")
      ->check(CLI::Range(0.1, 3600.0))
      ->capture_default_str();
  command
      .add_option("--max-windows", arguments.max_windows_n,
                  "a run ends after so many at most; sooner, when three in a row are within 10 %")
      ->check(CLI::Range(1, 10'000))
      ->capture_default_str();
  command.add_option("--out", arguments.out, "folder for load.json, load.csv and load.svg")
      ->type_name("DIR");
}

}  // namespace

void add_load_command(CLI::App& app) {
  const auto arguments = std::make_shared<LoadArguments>();
  arguments->servers = ServerArguments().servers;
  CLI::App* command = app.add_subcommand("load", "put servers under load, as many cells");
  add_options(*command, *arguments);
  set_help(
      *command,
      "Open loop: requests are due at planned instants, whatever became of those before, and "
      "latency counts from there.\n\n fixed     cells take turns at equal distances\n poisson   "
      "at random\n recorded  each cell as its frames were taken",
      {"grasp load build/piles=tee --cells 4 --rate 4 --window-s 1 --out build/load"});
  command->callback([arguments] { finish(run(*arguments)); });
}

}  // namespace graspd::program
