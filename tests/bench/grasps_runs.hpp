#pragma once

#include <optional>
#include <string>
#include <vector>

#include "graspd/judge/grasp_judge.hpp"
#include "graspd/parts/catalogue.hpp"
#include "graspd/perception/parameters.hpp"
#include "graspd/simulation/scene.hpp"
#include "graspd/types/answer.hpp"

/// What `./run bench grasps` does with one pile.
namespace graspd::bench {

struct JudgedGrasp {
  std::uint32_t object_id = 0;
  judge::Finding finding = judge::Finding::kGood;
  /// What went wrong: the finding's name, or what explains it better: `wrong_pose`, or `too_wide`
  /// where the jaws meet the very part that they are to grasp.
  std::string cause;
  bool is_pose_right = false;
  std::optional<std::size_t> held;  ///< the true part, of a good grasp
  bool lifts_free = false;          ///< and it pushes no other one

  bool is_good() const { return finding == judge::Finding::kGood; }
};

struct JudgedPlan {
  Outcome outcome = Outcome::kPlanned;
  std::vector<JudgedGrasp> grasps;  ///< as ranked

  /// Of each object the grasp that the agent would try first, in the order of the objects.
  std::vector<JudgedGrasp> first_of_objects() const;
};

/// A true part with the score that the planner gives it among all true parts.
struct ScoredPart {
  double grs = 0;
  bool lifts_free = false;
};

/// The next frame of the same pile, after the first grasp's part was taken. CPU times of plans.
struct AfterPick {
  bool is_unchanged = false;
  double with_last_plan_ms = 0;
  double anew_ms = 0;
};

struct Pile {
  const parts::Part* part = nullptr;
  simulation::SceneOptions scene;  ///< its first frame
};

struct JudgedPile {
  Pile pile;
  JudgedPlan descending, ascending;
  JudgedPlan from_truth;  ///< the true poses given, as a registration without error would
  std::vector<ScoredPart> scored;
  double grasp_stage_ms = 0;  ///< for all true parts: the least of some runs, wall clock
  /// Whether any good grasp exists; unknown where the search was given up.
  std::optional<bool> has_good_grasp;
  std::optional<AfterPick> after_pick;  ///< where the first grasp was good
};

Result<JudgedPile> judge_pile(const Pile& pile, const parts::Catalogue& catalogue,
                              const perception::Parameters& parameters);

}  // namespace graspd::bench
