#pragma once

#include <yaml-cpp/yaml.h>

#include <Eigen/Geometry>
#include <deque>
#include <filesystem>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "graspd/types/result.hpp"

/// The one configuration loader: every YAML file graspd reads goes through it. A key nobody asked
/// for, a missing key and a value of the wrong type are each named with file and line, and all of
/// them are reported together.
namespace graspd {

class YamlDocument;

/// One mapping of a document. Reading never throws: faults are collected in the document.
class YamlMap {
 public:
  /// Leaves `value` as it is where the key is absent: defaults live in code.
  template <class T>
  void optional(std::string_view key, T& value);
  /// An absent key is a fault.
  template <class T>
  void required(std::string_view key, T& value);
  /// As `optional`, for an enumeration by its names.
  template <class E>
  void optional_enum(std::string_view key, E& value);

  bool has(std::string_view key);
  /// An empty map where the key is absent.
  YamlMap map(std::string_view key);
  /// None where the key is absent.
  std::vector<YamlMap> list_of_maps(std::string_view key);

  /// Adds a fault at this key (or, with an empty key, at the map), for rules a type can't say.
  void fault(std::string_view key, const std::string& sentence);
  /// "part.yaml:12"
  std::string place(std::string_view key = {}) const;

 private:
  friend class YamlDocument;
  YamlMap(YamlDocument* document, const YAML::Node& node, std::set<std::string>* known)
      : document_(document), node_(node), known_(known) {}

  YAML::Node find(std::string_view key);
  void read(const YAML::Node& node, std::string_view key, double& value);
  void read(const YAML::Node& node, std::string_view key, int& value);
  void read(const YAML::Node& node, std::string_view key, std::uint32_t& value);
  void read(const YAML::Node& node, std::string_view key, bool& value);
  void read(const YAML::Node& node, std::string_view key, std::string& value);
  void read(const YAML::Node& node, std::string_view key, std::vector<double>& value);
  void read(const YAML::Node& node, std::string_view key, std::vector<std::string>& value);
  void read(const YAML::Node& node, std::string_view key, Eigen::Vector3d& value);
  /// 16 numbers, row by row, metres.
  void read(const YAML::Node& node, std::string_view key, Eigen::Isometry3d& value);

  YamlDocument* document_;
  YAML::Node node_;
  std::set<std::string>* known_;
};

/// Not movable: its maps point to it.
class YamlDocument {
 public:
  /// Faults in reading the file are faults of the document, as any other.
  explicit YamlDocument(std::filesystem::path path);
  YamlDocument(const YamlDocument&) = delete;
  YamlDocument& operator=(const YamlDocument&) = delete;

  YamlMap root();
  /// \returns INVALID_ARGUMENT with one line per fault, unknown keys among them.
  Result<void> finish();

 private:
  friend class YamlMap;
  YamlMap track(const YAML::Node& node);
  std::string place(const YAML::Node& node) const;

  struct Visited {
    YAML::Node node;
    std::set<std::string> known;
  };
  std::filesystem::path path_;
  YAML::Node node_;
  bool readable_ = false;
  std::deque<Visited> visited_;
  std::vector<std::string> faults_;
};

template <class T>
void YamlMap::optional(std::string_view key, T& value) {
  if (const YAML::Node node = find(key); node.IsDefined()) read(node, key, value);
}

template <class T>
void YamlMap::required(std::string_view key, T& value) {
  if (const YAML::Node node = find(key); node.IsDefined()) {
    read(node, key, value);
  } else {
    fault({}, fmt::format("key '{}' is missing", key));
  }
}

template <class E>
void YamlMap::optional_enum(std::string_view key, E& value) {
  std::string name;
  optional(key, name);
  if (name.empty()) return;
  if (const auto parsed = parse_enum<E>(name)) {
    value = *parsed;
  } else {
    fault(key, fmt::format("'{}' is no {}; known: {}", name, EnumNames<E>::what, names_of<E>()));
  }
}

}  // namespace graspd
