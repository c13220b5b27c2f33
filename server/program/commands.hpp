#pragma once

#include <CLI/CLI.hpp>

namespace graspd::program {

/// Adds `serve`: the perception server.
void add_serve_command(CLI::App& app);
/// Adds the hidden `worker`: what `serve` starts as its worker processes.
void add_worker_command(CLI::App& app);
/// Adds `part check MESH`: what is wrong with a mesh; and `part new`.
void add_part_command(CLI::App& app);
/// Adds `new MESH`: a part of a mesh, with a forecast.
void add_part_new_command(CLI::App& part);

}  // namespace graspd::program
