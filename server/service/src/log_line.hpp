#pragma once

#include <chrono>
#include <filesystem>
#include <string>
#include <string_view>

#include "graspd/types/answer.hpp"
#include "intake.hpp"
#include "work_report.hpp"

/// The server's log: one JSON object a line, whatever clients put into names and exceptions into
/// sentences.
namespace graspd::service {

/// {"message": …}
std::string log_line(std::string_view message);

/// How a request ended.
struct RequestEnd {
  Code code = Code::kOk;
  WorkReport report;
  std::chrono::nanoseconds queued{0};
  std::chrono::nanoseconds taken{0};  ///< from its arrival to its answer
  std::filesystem::path recorded;     ///< empty: it was not
};

/// Everything needed to find the request, to see where its time went, and to replay it: with frame
/// and request recorded and the three hashes, the answer can be computed again bit by bit.
std::string log_line(const PlanJob& plan, const RequestEnd& end, const ServerInfo& server);
/// One that was refused before it was read.
std::string log_line(const Refused& refused);

}  // namespace graspd::service
