#pragma once

#include <CLI/CLI.hpp>

namespace graspd::program {

/// Adds `plan`: asks for the grasps of one depth frame.
void add_plan_command(CLI::App& app);
/// Adds `health`: asks servers how they are.
void add_health_command(CLI::App& app);
/// Adds `stats`: what servers do, as a live table.
void add_stats_command(CLI::App& app);
/// Adds `console`: a web page of cells, plans and picks.
void add_console_command(CLI::App& app);
/// Adds `record`: makes a rawlog of what a server's flight recorder keeps.
void add_record_command(CLI::App& app);
/// Adds `replay`: asks again what was recorded, and compares the answers.
void add_replay_command(CLI::App& app);
/// Adds `load`: puts servers under load.
void add_load_command(CLI::App& app);

/// Adds `keys new|allow|revoke|list`: who may use a server.
void add_keys_command(CLI::App& app);

}  // namespace graspd::program
