#pragma once

#include <string>
#include <vector>

#include "graspd/onboarding/forecast.hpp"
#include "graspd/onboarding/stable_poses.hpp"
#include "graspd/parts/mesh_check.hpp"
#include "graspd/parts/part.hpp"

namespace graspd::onboarding {

/// All that was found out about a new part.
struct Onboarding {
  std::string mesh_name;
  int version = 1;
  std::vector<parts::MeshFinding> findings;
  parts::Part part;
  std::vector<StablePose> poses;
  ForecastOptions options;
  Forecast forecast;
  std::vector<std::string> commands;  ///< that say the same again
  std::string build;                  ///< of the program
};

/// By the share of piles whose first grasp was right.
enum class Fitness { kGood, kFair, kPoor };

/// Whether this cell can pick the part, in one sentence.
struct Verdict {
  Fitness fitness = Fitness::kPoor;
  std::string sentence;
};
/// Poor, whatever the forecast says, where jaws find no hold, their stroke is too short, or the
/// camera can't resolve the part.
Verdict verdict_of(const Onboarding& onboarding);

/// What would make it better, most important first; empty where nothing is known to.
std::vector<std::string> advice_for(const Onboarding& onboarding);

/// One line of the forecast.
struct Figure {
  std::string what;
  std::string value;
  std::string interval;  ///< 95 %; empty where there is none
  std::string of;        ///< what it was counted on
};
/// The lines of report and terminal, in this order.
std::vector<Figure> figures_of(const Onboarding& onboarding);

/// One of each name, for jaws, best first; their images are left out.
std::vector<parts::PickPoint> jaw_points_of(const parts::Part& part);
/// Between the jaws' inner faces, before they close.
double opening_for(const parts::PickPoint& point, const Gripper& gripper);

}  // namespace graspd::onboarding
