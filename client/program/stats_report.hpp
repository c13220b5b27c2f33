#pragma once

#include <string>
#include <vector>

#include "graspd/client/client.hpp"

namespace graspd::program {

/// What servers have done between two looks, as tables: one line a server, then one a stage. A
/// server that `before` does not have, or that has started since, is counted from its start.
std::string stats_report(const std::vector<client::ServerHealth>& before,
                         const std::vector<client::ServerHealth>& now);

}  // namespace graspd::program
