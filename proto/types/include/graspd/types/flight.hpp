#pragma once

#include <string>

#include "graspd/types/answer.hpp"

namespace graspd {

/// Of their files.
inline constexpr const char* kFlightExtension = ".flight";

/// What the server's flight recorder keeps of one request. Request, depth image and answer are the
/// bytes that crossed the wire, so that nothing is lost between them and a replay.
struct FlightRecord {
  std::string cell;
  double stamp_s = 0;  ///< when it was answered, since 1970
  ServerInfo server;   ///< of the parts that it was computed with
  std::string request;
  std::string depth_image;
  std::string answer;
};

}  // namespace graspd
