#include <spdlog/spdlog.h>

#include "commands.hpp"
#include "graspd/command_line/help.hpp"
#include "graspd/command_line/run_program.hpp"
#include "pick_report.hpp"

namespace graspd::robot_agent {
namespace {

struct ReportArguments {
  std::filesystem::path folder;
  bool markdown = false;
};

int report(const ReportArguments& arguments) {
  const auto runs = pick_records::read_runs(arguments.folder);
  if (!runs) {
    spdlog::error("{}", runs.error().message);
    return kExitWrongInput;
  }
  fmt::print("{}", pick_report(*runs, arguments.markdown));
  return kExitDone;
}

}  // namespace

void add_report_command(CLI::App& app) {
  const auto arguments = std::make_shared<ReportArguments>();
  CLI::App* command = app.add_subcommand("report", "sum up the records of one run or of many");
  command->add_option("DIR", arguments->folder, "a run's folder, or one with runs in it")
      ->required();
  command->add_flag("--markdown", arguments->markdown, "tables for a document");
  set_help(*command,
           "Prints success, picks per hour, the share of planning, and tables by part, failure and "
           "step.",
           {"robot_agent report build/tees"});
  command->callback([arguments] {
    if (const int code = report(*arguments)) throw CLI::RuntimeError(code);
  });
}

}  // namespace graspd::robot_agent
