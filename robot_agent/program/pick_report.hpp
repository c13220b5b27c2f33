#pragma once

#include <string>
#include <vector>

#include "graspd/pick_records/runs.hpp"

namespace graspd::robot_agent {

/// What users of a cell ask of its runs, as tables: the runs and how they ended; success, picks per
/// hour and the share of planning; by part; what failed and why; where the time went; which grasps
/// the arm could not take.
/// \param markdown for documents, else for a terminal.
std::string pick_report(const std::vector<pick_records::Run>& runs, bool markdown);

}  // namespace graspd::robot_agent
