#include "graspd/command_line/manual.hpp"

#include <algorithm>
#include <sstream>

#include "graspd/command_line/help.hpp"

namespace graspd {
namespace {

/// As troff shows it: hyphens that can be copied, no request by accident.
std::string escaped(const std::string& text) {
  std::string troff;
  for (const char c : text) {
    const bool at_start = troff.empty() || troff.back() == '\n';
    if (at_start && (c == '.' || c == '\'')) troff += "\\&";
    if (c == '\\') {
      troff += "\\e";
    } else if (c == '-') {
      troff += "\\-";
    } else {
      troff += c;
    }
  }
  return troff;
}

std::string bold(const std::string& text) { return "\\fB" + escaped(text) + "\\fR"; }
std::string italic(const std::string& text) { return "\\fI" + escaped(text) + "\\fR"; }

std::string upper(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(),
                 [](unsigned char c) { return static_cast<char>(std::toupper(c)); });
  return text;
}

/// As the line of a list, without a full stop.
std::string item(std::string text) {
  if (text.ends_with('.')) text.pop_back();
  if (text.size() > 1 && std::islower(static_cast<unsigned char>(text[1])) != 0) {
    text[0] = static_cast<char>(std::tolower(static_cast<unsigned char>(text[0])));
  }
  return escaped(text);
}

/// Its commands follow, or what it must have and may have.
std::string synopsis(const Command& command) {
  std::string text = ".B " + escaped(command.path) + "\n";
  for (const OptionHelp& option : options_of(*command.app)) {
    if (!option.is_required) continue;
    if (!option.flags.empty()) text += bold(option.flags.front()) + " ";
    text += italic(option.value) + "\n";
  }
  text += "[" + italic("option") + " ...]\n";
  if (command.app->get_require_subcommand_min() > 0) text += italic("command") + " ...\n";
  return text;
}

std::string options(const CLI::App& command) {
  std::string text;
  for (const OptionHelp& option : options_of(command)) {
    std::string names;
    for (const std::string& flag : option.flags) {
      names += (names.empty() ? "" : ", ") + bold(flag);
    }
    if (!option.value.empty()) names += (names.empty() ? "" : " ") + italic(option.value);
    text +=
        ".TP\n" + names + "\n" + escaped(option.text.empty() ? "see below" : option.text) + "\n";
  }
  return text;
}

/// Paragraphs; lines that are indented stand as they are.
std::string paragraphs(const std::string& notes) {
  std::string text;
  std::istringstream lines(notes);
  bool is_literal = false;
  bool is_new = true;
  for (std::string line; std::getline(lines, line);) {
    const bool literal = line.starts_with(' ');
    if (is_literal && !literal) text += ".EE\n";
    if (literal && !is_literal) text += ".PP\n.EX\n";
    if (!literal && !line.empty() && (is_new || is_literal)) text += ".PP\n";
    if (!line.empty()) text += escaped(line) + "\n";
    is_new = line.empty();
    is_literal = literal;
  }
  return is_literal ? text + ".EE\n" : text;
}

std::string examples(const CLI::App& command) {
  std::string text;
  for (const std::string& example : examples_of(command)) text += escaped(example) + "\n";
  return text.empty() ? "" : ".PP\nExamples:\n.PP\n.RS 4\n.EX\n" + text + ".EE\n.RE\n";
}

}  // namespace

std::string man_page(const CLI::App& program) {
  const std::vector<Command> commands = commands_of(program);
  std::string text =
      ".TH " + upper(program.get_name()) + " 1 \"\" graspd \"User Commands\"\n" + ".SH NAME\n" +
      escaped(program.get_name()) + " \\- " + item(program.get_description()) + "\n.SH SYNOPSIS\n" +
      synopsis(commands.front()) + ".SH OPTIONS\n" + options(program) + ".SH COMMANDS\n";
  for (const Command& command : commands) {
    if (command.app == &program) continue;
    text += ".SS " + escaped(command.path.substr(program.get_name().size() + 1)) + "\n" +
            item(command.app->get_description()) + ".\n.PP\n" + synopsis(command) +
            options(*command.app) + paragraphs(notes_of(*command.app)) + examples(*command.app);
  }
  text += ".SH NOTES\n" + paragraphs(notes_of(program)) + examples(program) + ".SH SEE ALSO\n";
  std::string others;
  for (const std::string name : {"grasp", "grasp_server", "robot_agent"}) {
    if (name == program.get_name()) continue;
    others += (others.empty() ? "" : ",\n") + (".BR " + name + " (1)");
  }
  // .BR takes what follows the name in roman, the comma too.
  for (std::size_t at = 0; (at = others.find("(1),", at)) != std::string::npos; ++at) {
    others.replace(at, 4, "(1) ,");
  }
  return text + others + "\n";
}

}  // namespace graspd
