#pragma once

#include <string>

#include "graspd/formats/yaml.hpp"
#include "graspd/perception/parameters.hpp"

namespace graspd::service {

/// Reads the keys of a `perception:` section. Absent keys stay as they are; a number out of its
/// range is a fault of the document.
void read_parameters(YamlMap map, perception::Parameters& parameters);

/// Every parameter as YAML, each line indented by `indent` more spaces. The same text for the same
/// parameters, always.
std::string parameters_to_yaml(const perception::Parameters& parameters, int indent);

}  // namespace graspd::service
