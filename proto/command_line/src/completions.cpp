#include "graspd/command_line/completions.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <sstream>
#include <stdexcept>

#include "graspd/command_line/help.hpp"

namespace graspd {
namespace {

/// What may stand where a value is due.
enum class ValueKind { kNothingKnown, kChoice, kFolder, kFile };

ValueKind kind_of(const OptionHelp& option) {
  if (!option.choices.empty()) return ValueKind::kChoice;
  if (option.value == "DIR") return ValueKind::kFolder;
  const auto is_part_of_value = [&](std::string_view word) {
    return option.value.find(word) != std::string::npos;
  };
  for (const std::string_view word : {"FILE", "PATH", "PNG", "YAML", "OLD"}) {
    if (is_part_of_value(word)) return ValueKind::kFile;
  }
  return ValueKind::kNothingKnown;
}

std::string join(const std::vector<std::string>& words) {
  std::string text;
  for (const std::string& word : words) text += (text.empty() ? "" : " ") + word;
  return text;
}

std::string identifier(std::string path) {
  std::replace(path.begin(), path.end(), ' ', '_');
  return "_" + path;
}

/// Within single quotes: for zsh and fish, which both take `'\''`.
std::string in_quotes(const std::string& text) {
  std::string shell = "'";
  for (const char c : text) shell += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return shell + "'";
}

/// The commands right below one.
std::vector<Command> below(const std::vector<Command>& commands, const Command& parent) {
  std::vector<Command> children;
  for (const Command& command : commands) {
    if (command.app->get_parent() == parent.app) children.push_back(command);
  }
  return children;
}

// bash

std::string bash_values(const OptionHelp& option) {
  switch (kind_of(option)) {
    case ValueKind::kChoice:
      return "compgen -W " + in_quotes(join(option.choices)) + " -- \"$word\"";
    case ValueKind::kFolder:
      return "compgen -d -- \"$word\"";
    case ValueKind::kFile:
      return "compgen -f -- \"$word\"";
    case ValueKind::kNothingKnown:
      break;
  }
  return ":";
}

std::string bash(const std::vector<Command>& commands) {
  const std::string& name = commands.front().path;
  std::string known;
  std::string values;
  std::string words;
  for (const Command& command : commands) {
    known += (known.empty() ? "" : " | ") + in_quotes(command.path);
    std::vector<std::string> offered;
    for (const Command& child : below(commands, command)) offered.push_back(child.app->get_name());
    std::string arguments;
    for (const OptionHelp& option : options_of(*command.app)) {
      if (option.flags.empty()) arguments = "; " + bash_values(option);
      for (const std::string& flag : option.flags) {
        offered.push_back(flag);
        if (option.value.empty()) continue;
        values +=
            "    " + in_quotes(command.path + " " + flag) + ") " + bash_values(option) + " ;;\n";
      }
    }
    words += "        " + in_quotes(command.path) + ") compgen -W " + in_quotes(join(offered)) +
             " -- \"$word\"" + arguments + " ;;\n";
  }
  return "# bash completion for " + name + "; made by " + name +
         " --print-completions bash\n"
         "_" +
         name +
         "_words() {\n"
         "  local word=$1 before=$2 command=$3\n"
         "  case \"$command $before\" in\n" +
         values +
         "    *)\n"
         "      case $command in\n" +
         words +
         "      esac\n"
         "      ;;\n"
         "  esac\n"
         "}\n"
         "_" +
         name +
         "() {\n"
         "  local command=" +
         name +
         " i\n"
         "  for ((i = 1; i < COMP_CWORD; i++)); do\n"
         "    case \"$command ${COMP_WORDS[i]}\" in\n"
         "      " +
         known +
         ") command+=\" ${COMP_WORDS[i]}\" ;;\n"
         "    esac\n"
         "  done\n"
         "  mapfile -t COMPREPLY < <(_" +
         name +
         "_words \"$2\" \"$3\" \"$command\")\n"
         "}\n"
         "complete -o filenames -F _" +
         name + " " + name + "\n";
}

// zsh

/// Within the brackets of _arguments.
std::string zsh_text(const std::string& text) {
  std::string zsh;
  for (const char c : text) zsh += std::string(c == '[' || c == ']' || c == ':' ? "\\" : "") + c;
  return zsh;
}

std::string zsh_values(const OptionHelp& option) {
  switch (kind_of(option)) {
    case ValueKind::kChoice:
      return "(" + join(option.choices) + ")";
    case ValueKind::kFolder:
      return "_files -/";
    case ValueKind::kFile:
      return "_files";
    case ValueKind::kNothingKnown:
      break;
  }
  return " ";
}

std::string zsh(const std::vector<Command>& commands) {
  const std::string& name = commands.front().path;
  std::string text = "#compdef " + name + "\n# made by " + name + " --print-completions zsh\n";
  for (const Command& command : commands) {
    text += identifier(command.path) + "() {\n  local context state line\n  _arguments -C";
    std::string arguments;
    for (const OptionHelp& option : options_of(*command.app)) {
      const std::string value = ":" + zsh_text(option.value) + ":" + zsh_values(option);
      if (option.flags.empty()) arguments += " \\\n    " + in_quotes("*" + value);
      for (const std::string& flag : option.flags) {
        text += " \\\n    " + in_quotes("*" + flag + "[" + zsh_text(option.text) + "]" +
                                        (option.value.empty() ? "" : value));
      }
    }
    const std::vector<Command> children = below(commands, command);
    if (children.empty()) {
      text += arguments + "\n}\n";
      continue;
    }
    std::string names;
    std::string calls;
    for (const Command& child : children) {
      const std::string& word = child.app->get_name();
      names += " " + in_quotes(word + ":" + child.app->get_description());
      calls += "      " + word + ") " + identifier(child.path) + " ;;\n";
    }
    text += fmt::format(
        " \\\n    '1: :->command' '*:: :->words'\n"
        "  case $state in\n"
        "    command) local -a commands=({} ); _describe command commands ;;\n"
        "    words) case $line[1] in\n{}    esac ;;\n  esac\n}}\n",
        names, calls);
  }
  return text + "if [ \"$funcstack[1]\" = _" + name + " ]; then _" + name +
         " \"$@\"; else compdef _" + name + " " + name + "; fi\n";
}

// fish

std::string fish(const std::vector<Command>& commands) {
  const std::string& name = commands.front().path;
  std::string text = "# fish completion for " + name + "; made by " + name +
                     " --print-completions fish\ncomplete -c " + name + " -f\n";
  for (const Command& command : commands) {
    // Where all words of its path have been said, and none of a command below it.
    std::string where;
    std::istringstream path(command.path.substr(name.size()));
    for (std::string word; path >> word;) {
      where += (where.empty() ? "" : "; and ") + ("__fish_seen_subcommand_from " + word);
    }
    const std::vector<Command> children = below(commands, command);
    std::vector<std::string> names;
    for (const Command& child : children) names.push_back(child.app->get_name());
    if (!names.empty()) {
      where += (where.empty() ? "" : "; and ") + ("not __fish_seen_subcommand_from " + join(names));
    }
    const std::string begin = "complete -c " + name + " -n " + in_quotes(where);
    for (const Command& child : children) {
      text += begin + " -a " + child.app->get_name() + " -d " +
              in_quotes(child.app->get_description()) + "\n";
    }
    for (const OptionHelp& option : options_of(*command.app)) {
      std::string values;
      switch (kind_of(option)) {
        case ValueKind::kChoice:
          values = " -x -a " + in_quotes(join(option.choices));
          break;
        case ValueKind::kFolder:
          values = " -x -a '(__fish_complete_directories)'";
          break;
        case ValueKind::kFile:
          values = option.flags.empty() ? " -F" : " -r -F";
          break;
        case ValueKind::kNothingKnown:
          values = option.value.empty() ? "" : " -x";
          break;
      }
      if (option.flags.empty() && kind_of(option) == ValueKind::kNothingKnown) continue;
      std::string flags;
      for (const std::string& flag : option.flags) {
        flags += flag.starts_with("--") ? " -l " + flag.substr(2) : " -s " + flag.substr(1);
      }
      text += fmt::format("{}{}{}{}\n", begin, flags, values,
                          flags.empty() ? "" : " -d " + in_quotes(option.text));
    }
  }
  return text;
}

}  // namespace

std::string completions(const CLI::App& program, std::string_view shell) {
  const std::vector<Command> commands = commands_of(program);
  if (shell == "bash") return bash(commands);
  if (shell == "zsh") return zsh(commands);
  if (shell == "fish") return fish(commands);
  throw std::invalid_argument("--print-completions " + std::string(shell) +
                              ": known: bash, zsh, fish");
}

}  // namespace graspd
