#pragma once

#include <Eigen/Geometry>
#include <array>
#include <nlohmann/json.hpp>
#include <string>

namespace graspd::record {

using Json = nlohmann::ordered_json;

/// 16 numbers, row by row.
inline std::array<double, 16> row_major(const Eigen::Isometry3d& T) {
  std::array<double, 16> numbers;
  Eigen::Map<Eigen::Matrix<double, 4, 4, Eigen::RowMajor>>(numbers.data()) = T.matrix();
  return numbers;
}

/// On one line. Bytes that are no UTF-8 (a file name in a message) are replaced, not thrown at.
inline std::string to_line(const Json& json) {
  return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

}  // namespace graspd::record
