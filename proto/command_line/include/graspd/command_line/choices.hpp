#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

#include "graspd/types/enum_names.hpp"

namespace graspd {

/// Lets an option have the names of an enumeration's values alone, and names them in --help, in
/// what is said of a wrong one, and to completions.
template <class E>
CLI::Validator one_of() {
  std::vector<std::string> names;
  for (const auto& [value, name] : EnumNames<E>::values) names.emplace_back(name);
  return CLI::IsMember(names);
}

}  // namespace graspd
