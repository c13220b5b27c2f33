#pragma once

#include <optional>
#include <string>
#include <vector>

#include "graspd/parts/mesh.hpp"

namespace graspd::parts {

/// Of an error, no part can be made.
enum class Severity { kOk, kWarning, kError };

struct MeshFinding {
  Severity severity = Severity::kOk;
  std::string topic;     ///< "units", "normals", "holes", "size", …
  std::string sentence;  ///< what is so, and what to do about it
};

/// The camera a part will be seen with.
struct SensorResolution {
  double focal_length_px = 365.5;
  double distance_m = 0.75;
  double depth_noise_m = 0.0014;
};

/// What `grasp_server part check` says of a mesh: units, normals, holes, doubled or degenerate
/// triangles, separate pieces, the symmetries found, size and walls against the sensor's
/// resolution.
/// \param declared the unit that its file was said to have; without it every mix-up is named that
/// would explain an unlikely size.
std::vector<MeshFinding> check_mesh(const Mesh& mesh, const SensorResolution& sensor,
                                    std::optional<LengthUnit> declared = std::nullopt);

}  // namespace graspd::parts

template <>
struct graspd::EnumNames<graspd::parts::Severity> {
  static constexpr std::string_view what = "severity";
  static constexpr std::pair<parts::Severity, std::string_view> values[] = {
      {parts::Severity::kOk, "ok"},
      {parts::Severity::kWarning, "warning"},
      {parts::Severity::kError, "error"}};
};
