#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <string_view>
#include <vector>

namespace graspd {

/// What stands below a command's options, in --help and in the manual.
/// \param notes paragraphs, parted by empty lines; lines that begin with a space stay as they are,
///   others are wrapped
/// \param examples whole command lines, each of which works where those of the command's siblings
///   have; long ones are broken as a shell has it, by a backslash at the end of a line
void set_help(CLI::App& command, std::string_view notes, const std::vector<std::string>& examples);

/// What set_help has been given, wrapped.
std::string notes_of(const CLI::App& command);
/// What set_help has been given, each a whole line.
std::vector<std::string> examples_of(const CLI::App& command);

/// A command of a program.
/// \param path the program's name and those of the commands, parted by spaces
struct Command {
  std::string path;
  const CLI::App* app;
};
/// Those for people, depth first: the program, then the commands below it.
std::vector<Command> commands_of(const CLI::App& program);

/// An option as people write it.
struct OptionHelp {
  std::vector<std::string> flags;  ///< "--json"; of an argument without a flag none
  std::string value;               ///< "FILE"; of a flag alone nothing
  std::vector<std::string> choices;
  std::string text;  ///< what it does, what it may be, what it is by default
  bool is_required = false;
};
/// Those for people; hidden ones are left out.
std::vector<OptionHelp> options_of(const CLI::App& command);

}  // namespace graspd
