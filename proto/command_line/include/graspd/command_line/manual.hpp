#pragma once

#include <CLI/CLI.hpp>
#include <string>

namespace graspd {

/// The manual page of a program with all of its commands, as troff for section 1.
std::string man_page(const CLI::App& program);

}  // namespace graspd
