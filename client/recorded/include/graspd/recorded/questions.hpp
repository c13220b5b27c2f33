#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>

#include "graspd/types/envelope.hpp"
#include "graspd/types/flight.hpp"

/// What was asked once, to be asked again, and what was answered: recordings (rawlogs), and what
/// the server's flight recorder keeps.
namespace graspd::recorded {

/// One frame with its request, and what was said to it then.
struct Question {
  std::string name;    ///< "frame 12", "tees/2026-11-22T14-43-58.123456Z_0123….flight"
  FlightRecord asked;  ///< a rawlog says nothing of cell and server, and its answer is below alone
  /// The plan, or what the server refused it with; nothing: none was recorded.
  std::optional<Result<PlanAnswer>> answered;
};

/// A recording, question by question. Belongs to one thread.
class Questions {
 public:
  virtual ~Questions() = default;
  /// Nothing after the last one.
  /// \returns INVALID_ARGUMENT where the recording can't be read further, and says where it broke.
  virtual Result<std::optional<Question>> next() = 0;
};

/// What to ask with frames that were recorded without a request.
struct AskWith {
  PlanRequest request;
  std::optional<CameraIntrinsics> camera;  ///< that the request was made for; nothing: any
};

/// \param path a rawlog, a .flight file, or a folder of them, however deep, in the order of their
/// time. Files are read one after the other.
/// \returns INVALID_ARGUMENT where there is nothing of this kind.
Result<std::unique_ptr<Questions>> open_questions(const std::filesystem::path& path,
                                                  std::optional<AskWith> ask_with = {});

/// Flight records that came after the one of this name; there may be none yet.
Result<std::unique_ptr<Questions>> open_flights_after(const std::filesystem::path& folder,
                                                      const std::string& name);

}  // namespace graspd::recorded
