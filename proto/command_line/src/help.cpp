#include "graspd/command_line/help.hpp"

#include <cstring>
#include <sstream>

namespace graspd {
namespace {

constexpr std::size_t kColumns_n = 88;
constexpr const char* kExamples = "Examples:\n";
constexpr const char* kIndent = "  ";

std::string wrap(std::string_view text) {
  std::string wrapped;
  std::istringstream lines{std::string(text)};
  for (std::string line; std::getline(lines, line);) {
    if (!wrapped.empty()) wrapped += '\n';
    if (line.starts_with(' ')) {
      wrapped += line;
      continue;
    }
    std::istringstream words{line};
    std::size_t columns_n = 0;
    for (std::string word; words >> word;) {
      if (columns_n > 0) wrapped += columns_n + 1 + word.size() > kColumns_n ? '\n' : ' ';
      columns_n = wrapped.empty() || wrapped.back() == '\n' ? 0 : columns_n + 1;
      wrapped += word;
      columns_n += word.size();
    }
  }
  return wrapped;
}

/// "TEXT:{a,b}" or "INT:INT in [1 - 5]" in its halves. The colons of "tcp://HOST:PORT" part
/// nothing.
std::pair<std::string, std::string> halves_of(const std::string& type) {
  const std::size_t at = type.find(':');
  if (at == std::string::npos || type.find("://") != std::string::npos) return {type, ""};
  return {type.substr(0, at), type.substr(at + 1)};
}

std::vector<std::string> split(const std::string& text, char separator) {
  std::vector<std::string> items;
  std::istringstream stream(text);
  for (std::string item; std::getline(stream, item, separator);) items.push_back(item);
  return items;
}

OptionHelp help_of(const CLI::Option& option) {
  OptionHelp help;
  for (const std::string& name : option.get_snames()) help.flags.push_back("-" + name);
  for (const std::string& name : option.get_lnames()) help.flags.push_back("--" + name);
  help.text = option.get_description();
  help.is_required = option.get_required();
  if (option.get_items_expected_max() == 0) return help;
  const auto [name, rule] = halves_of(option.get_type_name());
  help.value = help.flags.empty() ? option.get_name(true) : name;
  const auto add = [&](const std::string& text) {
    help.text += (help.text.empty() ? "" : "; ") + text;
  };
  if (rule.starts_with('{')) {
    help.choices = split(rule.substr(1, rule.size() - 2), ',');
    std::string names;
    for (const std::string& choice : help.choices) names += (names.empty() ? "" : ", ") + choice;
    add("one of " + names);
  } else if (!rule.empty()) {
    add(rule == "POSITIVE" ? "above 0" : rule);
  }
  if (!option.get_default_str().empty()) add("default: " + option.get_default_str());
  return help;
}

void add_commands(const CLI::App& app, const std::string& above, std::vector<Command>& commands) {
  commands.push_back({above + app.get_name(), &app});
  for (const CLI::App* below : app.get_subcommands([](const CLI::App*) { return true; })) {
    if (below->get_group().empty()) continue;  // not for people
    add_commands(*below, above + app.get_name() + " ", commands);
  }
}

}  // namespace

void set_help(CLI::App& command, std::string_view notes, const std::vector<std::string>& examples) {
  std::string footer = wrap(notes);
  if (!examples.empty()) footer += std::string(footer.empty() ? "" : "\n\n") + kExamples;
  for (std::string example : examples) {
    for (std::size_t at = 0; (at = example.find('\n', at)) != std::string::npos; ++at) {
      example.insert(at + 1, kIndent);
    }
    footer += kIndent + example + "\n";
  }
  if (footer.ends_with('\n')) footer.pop_back();
  command.footer(footer);
}

std::string notes_of(const CLI::App& command) {
  const std::string footer = command.get_footer();
  std::string notes = footer.substr(0, footer.find(kExamples));
  while (notes.ends_with('\n')) notes.pop_back();
  return notes;
}

std::vector<std::string> examples_of(const CLI::App& command) {
  const std::string footer = command.get_footer();
  const std::size_t at = footer.find(kExamples);
  if (at == std::string::npos) return {};
  std::vector<std::string> examples;
  std::istringstream lines(footer.substr(at + std::strlen(kExamples)));
  bool goes_on = false;
  for (std::string line; std::getline(lines, line);) {
    line.erase(0, std::strlen(kIndent));
    if (goes_on) {
      examples.back() += "\n" + line;
    } else {
      examples.push_back(line);
    }
    goes_on = line.ends_with('\\');
  }
  return examples;
}

std::vector<Command> commands_of(const CLI::App& program) {
  std::vector<Command> commands;
  add_commands(program, "", commands);
  return commands;
}

std::vector<OptionHelp> options_of(const CLI::App& command) {
  std::vector<OptionHelp> options;
  for (const CLI::Option* option : command.get_options()) {
    if (!option->get_group().empty()) options.push_back(help_of(*option));
  }
  return options;
}

}  // namespace graspd
