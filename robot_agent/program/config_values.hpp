#pragma once

#include <chrono>
#include <filesystem>
#include <string_view>

#include "graspd/formats/yaml.hpp"

/// Values that the sections of a cell's configuration have in common.
namespace graspd::robot_agent {

/// Empty where the key is absent and `text` is empty.
inline std::filesystem::path read_path(YamlMap& map, std::string_view key,
                                       const std::filesystem::path& relative_to,
                                       std::string text = "") {
  map.optional(key, text);
  return text.empty() ? std::filesystem::path() : relative_to / text;
}

inline std::filesystem::path require_path(YamlMap& map, std::string_view key,
                                          const std::filesystem::path& relative_to) {
  std::string text;
  map.required(key, text);
  return relative_to / text;
}

inline void read_not_negative(YamlMap& map, std::string_view key, double& value) {
  map.optional(key, value);
  if (value < 0) map.fault(key, fmt::format("'{}' must not be negative", key));
}

inline void read_duration(YamlMap& map, std::string_view key, std::chrono::milliseconds& value) {
  double seconds = std::chrono::duration<double>(value).count();
  read_not_negative(map, key, seconds);
  value = std::chrono::milliseconds(static_cast<std::int64_t>(seconds * 1e3));
}

}  // namespace graspd::robot_agent
