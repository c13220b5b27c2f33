#include "graspd/formats/yaml.hpp"

#include <algorithm>
#include <cmath>

namespace graspd {

YamlDocument::YamlDocument(std::filesystem::path path) : path_(std::move(path)) {
  try {
    node_ = YAML::LoadFile(path_.string());
    readable_ = true;
  } catch (const YAML::BadFile&) {
    faults_.push_back(fmt::format("{}: can't be read; is the path right?", path_.string()));
  } catch (const YAML::ParserException& e) {
    faults_.push_back(fmt::format("{}:{}: not YAML: {}", path_.string(), e.mark.line + 1, e.msg));
  }
}

YamlMap YamlDocument::root() {
  if (faults_.empty() && node_.IsNull()) return track(YAML::Node(YAML::NodeType::Map));
  if (faults_.empty() && !node_.IsMap()) {
    faults_.push_back(fmt::format("{}: the file must be a mapping of keys", path_.string()));
  }
  return track(node_);
}

YamlMap YamlDocument::track(const YAML::Node& node) {
  visited_.push_back({node.IsMap() ? node : YAML::Node(YAML::NodeType::Map), {}});
  return YamlMap(this, visited_.back().node, &visited_.back().known);
}

Result<void> YamlDocument::finish() {
  for (const Visited& visited : visited_) {
    for (const auto& entry : visited.node) {
      const auto key = entry.first.as<std::string>("?");
      if (visited.known.contains(key)) continue;
      faults_.push_back(fmt::format("{}: unknown key '{}'; known here: {}", place(entry.first), key,
                                    fmt::join(visited.known, ", ")));
    }
  }
  if (faults_.empty()) return {};
  return invalid("{}", fmt::join(faults_, "\n"));
}

std::string YamlDocument::place(const YAML::Node& node) const {
  const int line = node.Mark().line;
  return line < 0 ? path_.string() : fmt::format("{}:{}", path_.string(), line + 1);
}

YAML::Node YamlMap::find(std::string_view key) {
  known_->emplace(key);
  const YAML::Node& map = node_;  // the const subscript does not insert
  const YAML::Node found = map[std::string(key)];
  return found.IsDefined() && !found.IsNull() ? found : YAML::Node(YAML::NodeType::Undefined);
}

bool YamlMap::has(std::string_view key) { return find(key).IsDefined(); }

YamlMap YamlMap::map(std::string_view key) {
  const YAML::Node node = find(key);
  if (!node.IsDefined()) return document_->track(YAML::Node(YAML::NodeType::Map));
  if (!node.IsMap()) fault(key, fmt::format("'{}' must be a mapping of keys", key));
  return document_->track(node);
}

std::vector<YamlMap> YamlMap::list_of_maps(std::string_view key) {
  const YAML::Node node = find(key);
  std::vector<YamlMap> maps;
  if (!node.IsDefined()) return maps;
  if (!node.IsSequence()) {
    fault(key, fmt::format("'{}' must be a list", key));
    return maps;
  }
  for (const auto& item : node) {
    if (!item.IsMap()) fault(key, fmt::format("each entry of '{}' must be a mapping", key));
    maps.push_back(document_->track(item));
  }
  return maps;
}

void YamlMap::fault(std::string_view key, const std::string& sentence) {
  if (!document_->readable_) return;  // that is the one fault to report
  document_->faults_.push_back(place(key) + ": " + sentence);
}

std::string YamlMap::place(std::string_view key) const {
  const YAML::Node& map = node_;
  if (!key.empty()) {
    if (const YAML::Node found = map[std::string(key)]; found.IsDefined()) {
      return document_->place(found);
    }
  }
  return document_->place(node_);
}

namespace {

/// Numbers of one row after the other, whether written flat or as a list of rows.
bool flatten(const YAML::Node& node, std::vector<double>& out) {
  if (node.IsSequence()) {
    return std::all_of(node.begin(), node.end(),
                       [&](const YAML::Node& item) { return flatten(item, out); });
  }
  double value = 0;
  if (!node.IsScalar() || !YAML::convert<double>::decode(node, value) || !std::isfinite(value)) {
    return false;
  }
  out.push_back(value);
  return true;
}

}  // namespace

void YamlMap::read(const YAML::Node& node, std::string_view key, double& value) {
  double parsed = 0;
  if (node.IsScalar() && YAML::convert<double>::decode(node, parsed) && std::isfinite(parsed)) {
    value = parsed;
  } else {
    fault(key, fmt::format("'{}' must be a number", key));
  }
}

void YamlMap::read(const YAML::Node& node, std::string_view key, int& value) {
  if (!node.IsScalar() || !YAML::convert<int>::decode(node, value)) {
    fault(key, fmt::format("'{}' must be a whole number", key));
  }
}

void YamlMap::read(const YAML::Node& node, std::string_view key, std::uint32_t& value) {
  int parsed = 0;
  if (node.IsScalar() && YAML::convert<int>::decode(node, parsed) && parsed >= 0) {
    value = static_cast<std::uint32_t>(parsed);
  } else {
    fault(key, fmt::format("'{}' must be a whole number, 0 or above", key));
  }
}

void YamlMap::read(const YAML::Node& node, std::string_view key, bool& value) {
  if (!node.IsScalar() || !YAML::convert<bool>::decode(node, value)) {
    fault(key, fmt::format("'{}' must be true or false", key));
  }
}

void YamlMap::read(const YAML::Node& node, std::string_view key, std::string& value) {
  if (node.IsScalar()) {
    value = node.Scalar();
  } else {
    fault(key, fmt::format("'{}' must be text", key));
  }
}

void YamlMap::read(const YAML::Node& node, std::string_view key, std::vector<double>& value) {
  std::vector<double> parsed;
  if (node.IsSequence() && flatten(node, parsed)) {
    value = std::move(parsed);
  } else {
    fault(key, fmt::format("'{}' must be a list of numbers", key));
  }
}

void YamlMap::read(const YAML::Node& node, std::string_view key, std::vector<std::string>& value) {
  const auto is_text = [](const YAML::Node& item) { return item.IsScalar(); };
  if (!node.IsSequence() || !std::all_of(node.begin(), node.end(), is_text)) {
    fault(key, fmt::format("'{}' must be a list of texts", key));
    return;
  }
  value.clear();
  for (const auto& item : node) value.push_back(item.Scalar());
}

void YamlMap::read(const YAML::Node& node, std::string_view key, Eigen::Vector3d& value) {
  std::vector<double> parsed;
  if (node.IsSequence() && flatten(node, parsed) && parsed.size() == 3) {
    value = Eigen::Vector3d(parsed[0], parsed[1], parsed[2]);
  } else {
    fault(key, fmt::format("'{}' must be a list of 3 numbers", key));
  }
}

void YamlMap::read(const YAML::Node& node, std::string_view key, Eigen::Isometry3d& value) {
  std::vector<double> parsed;
  if (!node.IsSequence() || !flatten(node, parsed) || parsed.size() != 16) {
    fault(key, fmt::format("'{}' must be 16 numbers, a 4 × 4 pose row by row", key));
    return;
  }
  Eigen::Isometry3d T;
  T.matrix() = Eigen::Map<const Eigen::Matrix<double, 4, 4, Eigen::RowMajor>>(parsed.data());
  const double error =
      (T.linear() * T.linear().transpose() - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff();
  const bool last_row_ok = T.matrix().row(3).isApprox(Eigen::RowVector4d(0, 0, 0, 1));
  if (error > 1e-3 || T.linear().determinant() < 0 || !last_row_ok) {
    fault(key, fmt::format("'{}' is no pose: its 3 × 3 part must be a rotation, its last row "
                           "0 0 0 1",
                           key));
    return;
  }
  // Files carry few digits: take the nearest rotation.
  T.linear() = Eigen::Quaterniond(T.linear()).normalized().toRotationMatrix();
  value = T;
}

}  // namespace graspd
