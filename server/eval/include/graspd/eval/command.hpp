#pragma once

#include <CLI/CLI.hpp>

namespace graspd::eval {

/// Adds `eval SCENE_DIR …`: runs the pipeline on a BOP scene folder, without a network.
void add_eval_command(CLI::App& app);

}  // namespace graspd::eval
