#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "graspd/types/enum_names.hpp"

/// What truly became of a pick: what the simulated cell saw happen, and the verdict on it.
namespace graspd::sim_cell {

/// Something of the robot against something of the cell, from the first time on.
struct Touch {
  std::string by;                   ///< "palm", "jaw", or a link's name
  std::string what;                 ///< "bin", "table", "place box", "part 7"
  std::optional<std::size_t> part;  ///< where it is one
  bool is_before_closing = true;
  double force_n = 0;  ///< the largest; 0 for what can't give way
  double time_s = 0;   ///< since the trace began
};

/// From one frame of the camera to the next.
struct PickTrace {
  std::vector<Touch> touches;  ///< each pair once before and once after closing
  bool has_closed = false;     ///< the gripper was told to
  std::vector<std::size_t>
      lifted;  ///< parts that rose out of the pile while the gripper was closed
  std::vector<std::size_t> placed;  ///< parts that lie in the place box at the end
  std::vector<double> moved_m;      ///< of each part in the bin: its centre, from start to end
  double duration_s = 0;
};

/// What truly became of a pick. A collision counts before all else.
enum class PickVerdict {
  kSuccess,    ///< the intended part alone was lifted out of the pile and put into the place box
  kCollision,  ///< the robot touched bin, table or place box, or another part before closing
  kMissed,     ///< nothing was lifted
  kWrongPart,  ///< what was lifted is not the intended part
  kDropped,    ///< the intended part was lifted, and is not in the place box
  kDouble,     ///< another part came with it
};

/// The truth about one pick.
struct JudgedPick {
  PickVerdict verdict = PickVerdict::kMissed;
  std::string why;            ///< a sentence, but for SUCCESS
  double others_moved_m = 0;  ///< the farthest of the parts that were neither lifted nor intended
};

/// \param intended the part that the plan's object is; none where it is no part of the cell.
/// Pressing on the intended part itself before closing counts as a collision, brushing past it does
/// not.
JudgedPick judge(const PickTrace& trace, std::optional<std::size_t> intended);

}  // namespace graspd::sim_cell

template <>
struct graspd::EnumNames<graspd::sim_cell::PickVerdict> {
  using Verdict = sim_cell::PickVerdict;
  static constexpr std::string_view what = "verdict";
  static constexpr std::pair<Verdict, std::string_view> values[] = {
      {Verdict::kSuccess, "SUCCESS"}, {Verdict::kCollision, "COLLISION"},
      {Verdict::kMissed, "MISSED"},   {Verdict::kWrongPart, "WRONG_PART"},
      {Verdict::kDropped, "DROPPED"}, {Verdict::kDouble, "DOUBLE"}};
};
