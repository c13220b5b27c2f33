#include <fmt/format.h>

#include <cstdio>
#include <memory>

#include "commands.hpp"
#include "diff_report.hpp"
#include "exit_codes.hpp"
#include "graspd/client/client.hpp"
#include "graspd/codec/codec.hpp"
#include "graspd/command_line/help.hpp"
#include "graspd/command_line/progress.hpp"
#include "graspd/recorded/answers_file.hpp"
#include "graspd/recorded/questions.hpp"
#include "plan_report.hpp"
#include "request_arguments.hpp"
#include "server_arguments.hpp"

namespace graspd::program {
namespace {

using recorded::AnswersReader;
using recorded::AnswersWriter;
using recorded::Questions;

struct ReplayArguments {
  ServerArguments servers;
  std::string file;
  RequestArguments request;
  std::vector<std::string> diff;
  std::string out;
  int budget_ms = 10'000;
  bool json = false;
};

Result<std::unique_ptr<Questions>> open(const ReplayArguments& arguments) {
  if (arguments.request.camera.empty()) return recorded::open_questions(arguments.file);
  auto asked = read_cell_request(arguments.request);
  if (!asked) return tl::unexpected(asked.error());
  return recorded::open_questions(arguments.file,
                                  recorded::AskWith{std::move(asked->request), asked->camera});
}

std::uint32_t depth_crc32_of(const FlightRecord& asked) {
  const auto request = codec::decode_request(std::as_bytes(std::span(asked.request)));
  return request ? std::get<PlanCall>(request->call).frame.payload_crc32 : 0;
}

/// Asks all that can be read.
Result<void> replay_all(const ReplayArguments& arguments, Questions& questions,
                        client::Client& client, AnswersWriter* out, DiffReport& report) {
  Progress progress("answers");
  const bool is_only_one = std::filesystem::path(arguments.file).extension() == kFlightExtension;
  while (true) {
    auto question = questions.next();
    if (!question) return tl::unexpected(question.error());
    if (!*question) return {};
    const auto& [name, asked, answered] = **question;
    const auto start = std::chrono::steady_clock::now();
    const auto answer = client.ask_again(asked.request, asked.depth_image,
                                         std::chrono::milliseconds(arguments.budget_ms));
    const auto round_trip = std::chrono::steady_clock::now() - start;
    progress.hide();
    if (answer && (arguments.json || is_only_one)) print_plan(*answer, arguments.json, round_trip);
    const std::string text = report.add(name, answered, answer);
    if (!arguments.json) fmt::print("{}", text);
    if (std::fflush(stdout) != 0) return fail(Code::kInternal, "nobody reads any more");
    progress.step();
    if (out == nullptr) continue;
    if (auto ok = out->add({name, depth_crc32_of(asked), answer}); !ok) return ok;
  }
}

int exit_code_of(const DiffReport& report) {
  if (const auto failure = report.failure()) return exit_code(failure->code);
  return report.any_differs() ? kExitDiffers : 0;
}

Result<int> replay(const ReplayArguments& arguments) {
  const auto questions = open(arguments);
  if (!questions) return tl::unexpected(questions.error());
  std::optional<AnswersWriter> out;
  if (!arguments.out.empty()) {
    auto writer = AnswersWriter::create(arguments.out);
    if (!writer) return tl::unexpected(writer.error());
    out = *std::move(writer);
  }
  auto options = client_options(arguments.servers);
  if (!options) return tl::unexpected(options.error());
  client::Client client(arguments.servers.servers, *std::move(options));
  DiffReport report;
  const auto done = replay_all(arguments, **questions, client, out ? &*out : nullptr, report);
  if (!arguments.json) fmt::print("{}", report.summary());
  if (!done) return tl::unexpected(done.error());
  if (report.asked_n() == 0) return invalid("{}: no frame is in it", arguments.file);
  return exit_code_of(report);
}

Result<int> compare(const std::string& old_file, const std::string& new_file) {
  auto old_answers = AnswersReader::open(old_file);
  if (!old_answers) return tl::unexpected(old_answers.error());
  auto new_answers = AnswersReader::open(new_file);
  if (!new_answers) return tl::unexpected(new_answers.error());
  DiffReport report;
  while (true) {
    auto before = old_answers->next();
    if (!before) return tl::unexpected(before.error());
    auto now = new_answers->next();
    if (!now) return tl::unexpected(now.error());
    if (!*before && !*now) break;
    if (!*before || !*now) {
      fmt::print("{}", report.summary());
      return invalid("{} ends after {} answers, {} goes on", *before ? new_file : old_file,
                     report.asked_n(), *before ? old_file : new_file);
    }
    if ((*before)->depth_crc32 != (*now)->depth_crc32) {
      return invalid("{} of {} and {} of {} are not of one depth image: replay the same recording",
                     (*before)->name, old_file, (*now)->name, new_file);
    }
    fmt::print("{}", report.add((*now)->name, (*before)->answer, (*now)->answer));
  }
  fmt::print("{}", report.summary());
  return report.any_differs() ? kExitDiffers : 0;
}

}  // namespace

void add_replay_command(CLI::App& app) {
  const auto arguments = std::make_shared<ReplayArguments>();
  CLI::App* command =
      app.add_subcommand("replay", "ask again what was recorded, and compare the answers");
  CLI::Option* file = command
                          ->add_option("file", arguments->file,
                                       "a rawlog, a .flight file of a server's flight recorder, or "
                                       "a folder of them")
                          ->type_name("FILE");
  CLI::Option* diff =
      command
          ->add_option("--diff", arguments->diff, "compare the answers of two replays; asks nobody")
          ->expected(2)
          ->type_name("OLD NEW")
          ->excludes(file);
  for (CLI::Option* option : add_request_options(*command, arguments->request)) {
    option->description(option->get_description() + "; for a rawlog without requests");
  }
  command->get_option("--camera")->needs(command->get_option("--part"));
  command->get_option("--part")->needs(command->get_option("--camera"));
  command->add_option("--out", arguments->out, "write the answers, for --diff")->type_name("FILE");
  add_server_options(*command, arguments->servers);
  command->add_option("--budget-ms", arguments->budget_ms, "how long to wait for each answer")
      ->check(CLI::Range(1, 3'600'000))
      ->capture_default_str();
  command->add_flag("--json", arguments->json, "print the whole answers as JSON, and nothing else");
  set_help(
      *command,
      "Says of each grasp that changed by how much, and which stage's results were the first to "
      "differ. Where the recording has answers (grasp record, the flight recorder), it compares "
      "with them.\n\n"
      "Exit codes: 0 answered, and as before; 5 answers differ from those before; else as plan's.",
      {"grasp replay build/tees.rawlog --out build/old.jsonl",
       "grasp replay build/tees.rawlog --out build/new.jsonl",
       "grasp replay --diff build/old.jsonl build/new.jsonl"});
  command->callback([arguments, file, diff] {
    if (file->count() + diff->count() == 0) {
      throw CLI::RequiredError("FILE or --diff OLD NEW");
    }
    finish(diff->count() > 0 ? compare(arguments->diff[0], arguments->diff[1])
                             : replay(*arguments));
  });
}

}  // namespace graspd::program
