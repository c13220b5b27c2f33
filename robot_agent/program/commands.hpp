#pragma once

#include <CLI/CLI.hpp>

namespace graspd::robot_agent {

/// Adds `calibrate`: where the camera stands, and what its depth is off by.
void add_calibrate_command(CLI::App& app);
/// Adds `run`: picks in a cell.
void add_run_command(CLI::App& app);
/// Adds `record`: writes what a cell's camera sees.
void add_record_command(CLI::App& app);
/// Adds `report`: sums up the records of runs.
void add_report_command(CLI::App& app);
/// Adds `simulate`: records piles of a simulated cell.
void add_simulate_command(CLI::App& app);

}  // namespace graspd::robot_agent
