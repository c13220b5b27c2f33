#include "graspd/command_line/run_program.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <numeric>
#include <optional>
#include <stdexcept>
#include <string_view>

#include "graspd/command_line/completions.hpp"
#include "graspd/command_line/help.hpp"
#include "graspd/command_line/manual.hpp"

namespace graspd {
namespace {

/// What a program tells of itself to builds and tests, rather than to people.
std::optional<std::string> asked_of_itself(const CLI::App& app, int count, char** words) {
  const std::string_view what = count > 1 ? words[1] : "";
  if (what == "--print-man") return man_page(app);
  if (what == "--print-completions") return completions(app, count > 2 ? words[2] : "");
  if (what != "--print-examples") return std::nullopt;
  std::string text;
  for (const Command& command : commands_of(app)) {
    const auto examples = examples_of(*command.app);
    if (examples.empty()) text += command.path + ": \n";
    for (const std::string& example : examples) text += command.path + ": " + example + "\n";
  }
  return text;
}

/// The command that the words have named so far.
Command command_of(const CLI::App& app) {
  Command command{app.get_name(), &app};
  while (!command.app->get_subcommands().empty()) {
    command.app = command.app->get_subcommands().front();
    command.path += " " + command.app->get_name();
  }
  return command;
}

/// How many letters are to be added, left out or changed to make one word of the other.
std::size_t edits_n(std::string_view a, std::string_view b) {
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 0; i < a.size(); ++i) {
    std::size_t diagonal = row[0]++;
    for (std::size_t j = 0; j < b.size(); ++j) {
      const std::size_t changed = diagonal + (a[i] == b[j] ? 0 : 1);
      diagonal = row[j + 1];
      row[j + 1] = std::min({changed, diagonal + 1, row[j] + 1});
    }
  }
  return row.back();
}

/// What a word that is not known was perhaps meant to be: an option or a command; else nothing.
std::string meant_by(const std::string& word, const CLI::App& command) {
  constexpr std::size_t kTypos_n = 2;
  std::vector<std::string> known;
  for (const OptionHelp& option : options_of(command)) {
    known.insert(known.end(), option.flags.begin(), option.flags.end());
  }
  for (const CLI::App* below : command.get_subcommands([](const CLI::App*) { return true; })) {
    known.push_back(below->get_name());
  }
  const auto nearest =
      std::min_element(known.begin(), known.end(), [&](const std::string& a, const std::string& b) {
        return edits_n(word, a) < edits_n(word, b);
      });
  return nearest != known.end() && edits_n(word, *nearest) <= kTypos_n ? *nearest : "";
}

std::string failure_message(const CLI::App* app, const CLI::Error& error) {
  const Command command = command_of(*app);
  std::string text = command.path + ": " + error.what() + "\n";
  for (const std::string& word : app->remaining(true)) {
    const std::string meant = meant_by(word, *command.app);
    if (!meant.empty()) text += fmt::format("'{}' is not known; is '{}' meant?\n", word, meant);
  }
  return text + fmt::format("'{}' says what there is.\n", command.path + " --help");
}

}  // namespace

int run_program(const std::string& name, int count, char** words,
                const std::function<void(CLI::App&)>& describe) {
  try {
    CLI::App app("", name);
    app.failure_message(failure_message);
    describe(app);
    if (const auto text = asked_of_itself(app, count, words)) {
      std::fputs(text->c_str(), stdout);
      return kExitDone;
    }
    try {
      app.parse(count, words);
    } catch (const CLI::RuntimeError& error) {
      return error.get_exit_code();
    } catch (const CLI::ParseError& error) {
      return app.exit(error) == 0 ? kExitDone : kExitWrongInput;
    }
    return kExitDone;
  } catch (const std::invalid_argument& error) {
    std::fprintf(stderr, "%s: INVALID_ARGUMENT: %s\n", name.c_str(), error.what());
    return kExitWrongInput;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s: %s\n", name.c_str(), error.what());
    return kExitFailed;
  }
}

}  // namespace graspd
