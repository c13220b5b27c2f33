#pragma once

#include <string>
#include <vector>

#include "graspd/client/client.hpp"

namespace graspd::program {

/// What a simulated cell sends.
struct LoadRecording {
  std::vector<client::PreparedPlan> plans;
  std::vector<double> stamps_s;  ///< when each frame was taken; empty where it isn't said
  std::string note;  ///< one sentence, where not all of the recording is used; else empty
};

/// Reads a recording for a load test, its first 100 frames.
///
/// \param what what `recorded::open_questions` reads; or RECORDING=PART,PART: such a recording or
/// the folder of a BOP scene, and which parts are asked for \returns INVALID_ARGUMENT where not one
/// frame can be read. Of a damaged recording those before the damage are taken, and the note says
/// where it broke.
Result<LoadRecording> read_load_recording(const std::string& what, DepthEncoding encoding);

}  // namespace graspd::program
