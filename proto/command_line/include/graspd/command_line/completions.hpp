#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <string_view>

namespace graspd {

/// A script with which a shell completes a program's commands, options and their values.
/// \param shell "bash", "zsh" or "fish"
/// \throws std::invalid_argument for another shell
std::string completions(const CLI::App& program, std::string_view shell);

}  // namespace graspd
