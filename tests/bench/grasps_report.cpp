#include "grasps_report.hpp"

#include <algorithm>
#include <functional>
#include <map>

#include "graspd/eval/quantile.hpp"

namespace graspd::bench {
namespace {

constexpr int kTimedParts = 45;
constexpr std::size_t kRanksDrawn = 12;

using Piles = std::span<const JudgedPile>;
using PlanOf = JudgedPlan JudgedPile::*;
using Figure = std::optional<double>;

struct Share {
  int hits_n = 0, all_n = 0;

  void count(bool is_hit) {
    hits_n += is_hit;
    ++all_n;
  }
  Figure value() const {
    return all_n == 0 ? Figure() : Figure(static_cast<double>(hits_n) / all_n);
  }
};

Figure median(const std::vector<double>& values) {
  return values.empty() ? Figure() : Figure(eval::quantile(values, 0.5));
}

/// Of the piles with an answered grasp.
Share first_grasp_good(Piles piles, PlanOf plan) {
  Share share;
  for (const JudgedPile& pile : piles) {
    const auto& grasps = (pile.*plan).grasps;
    if (!grasps.empty()) share.count(grasps.front().is_good());
  }
  return share;
}

/// Of the piles that have a good grasp.
Share offered_where_exists(Piles piles, PlanOf plan) {
  Share share;
  for (const JudgedPile& pile : piles) {
    if (pile.has_good_grasp.value_or(false)) {
      share.count(std::ranges::any_of((pile.*plan).grasps, &JudgedGrasp::is_good));
    }
  }
  return share;
}

/// How often what succeeds stands before what does not, over all such pairs within a pile; ties
/// count half. \param scored for each pile its candidates: a score, higher first, and success.
Figure area_under_curve(const std::vector<std::vector<std::pair<double, bool>>>& scored) {
  double before = 0;
  double pairs_n = 0;
  for (const auto& pile : scored) {
    for (const auto& [score, succeeds] : pile) {
      if (!succeeds) continue;
      for (const auto& [other_score, other_succeeds] : pile) {
        if (other_succeeds) continue;
        before += score > other_score ? 1 : score == other_score ? 0.5 : 0;
        ++pairs_n;
      }
    }
  }
  return pairs_n == 0 ? Figure() : Figure(before / pairs_n);
}

/// Of the first grasp of each object, by its rank; success is a good grasp of a part that lifts
/// free.
Figure rank_auc(Piles piles, PlanOf plan) {
  std::vector<std::vector<std::pair<double, bool>>> scored;
  for (const JudgedPile& pile : piles) {
    auto& candidates = scored.emplace_back();
    for (const JudgedGrasp& grasp : (pile.*plan).first_of_objects()) {
      candidates.emplace_back(-static_cast<double>(candidates.size()), grasp.lifts_free);
    }
  }
  return area_under_curve(scored);
}

/// Of all true parts, by their score alone.
Figure lift_auc(Piles piles) {
  std::vector<std::vector<std::pair<double, bool>>> scored;
  for (const JudgedPile& pile : piles) {
    auto& candidates = scored.emplace_back();
    for (const ScoredPart& part : pile.scored) candidates.emplace_back(part.grs, part.lifts_free);
  }
  return area_under_curve(scored);
}

Figure grasp_stage_ms(Piles piles) {
  std::vector<double> times_ms;
  for (const JudgedPile& pile : piles) {
    if (pile.scored.size() == kTimedParts) times_ms.push_back(pile.grasp_stage_ms);
  }
  return median(times_ms);
}

struct Unchanged {
  Share answered;
  Figure unchanged_ms, anew_ms, speedup;
  Figure saved_ms;  ///< mean of a pick, those among them that have to plan anew after all
};

Unchanged unchanged_of(Piles piles) {
  Unchanged result;
  std::vector<double> unchanged_ms, anew_ms;
  double saved_ms = 0;
  for (const JudgedPile& pile : piles) {
    if (!pile.after_pick) continue;
    result.answered.count(pile.after_pick->is_unchanged);
    saved_ms += pile.after_pick->anew_ms - pile.after_pick->with_last_plan_ms;
    if (!pile.after_pick->is_unchanged) continue;
    unchanged_ms.push_back(pile.after_pick->with_last_plan_ms);
    anew_ms.push_back(pile.after_pick->anew_ms);
  }
  result.unchanged_ms = median(unchanged_ms);
  result.anew_ms = median(anew_ms);
  if (result.unchanged_ms) result.speedup = *result.anew_ms / *result.unchanged_ms;
  if (result.answered.all_n > 0) result.saved_ms = saved_ms / result.answered.all_n;
  return result;
}

std::string percent(const Share& share) {
  return share.all_n == 0 ? "–" : fmt::format("{:.1f}", 100 * *share.value());
}

std::string decimal(const Figure& figure, int digits) {
  return figure ? fmt::format("{:.{}f}", *figure, digits) : "–";
}

nlohmann::json number(const Figure& figure) {
  return figure ? nlohmann::json(*figure) : nlohmann::json();
}

std::vector<std::string> row_of(const std::string& name, Piles piles) {
  return {name,
          std::to_string(piles.size()),
          percent(first_grasp_good(piles, &JudgedPile::descending)),
          percent(offered_where_exists(piles, &JudgedPile::descending)),
          percent(first_grasp_good(piles, &JudgedPile::from_truth)),
          percent(offered_where_exists(piles, &JudgedPile::from_truth)),
          decimal(rank_auc(piles, &JudgedPile::descending), 2),
          decimal(rank_auc(piles, &JudgedPile::ascending), 2),
          decimal(lift_auc(piles), 2),
          decimal(grasp_stage_ms(piles), 1),
          percent(unchanged_of(piles).answered),
          decimal(unchanged_of(piles).speedup, 1)};
}

std::map<std::string, int> causes_of(Piles piles, PlanOf plan) {
  std::map<std::string, int> causes;
  for (const JudgedPile& pile : piles) {
    const JudgedPlan& judged = pile.*plan;
    const bool has_grasp = !judged.grasps.empty();
    ++causes[has_grasp ? judged.grasps.front().cause : std::string(name_of(judged.outcome))];
  }
  return causes;
}

/// Success by rank, over the piles whose answer is so long.
nlohmann::json curve_of(Piles piles, PlanOf plan) {
  std::vector<Share> good(kRanksDrawn), lifted(kRanksDrawn);
  for (const JudgedPile& pile : piles) {
    const auto first = (pile.*plan).first_of_objects();
    for (std::size_t rank = 0; rank < std::min(first.size(), kRanksDrawn); ++rank) {
      good[rank].count(first[rank].is_good());
      lifted[rank].count(first[rank].lifts_free);
    }
  }
  nlohmann::json curve = nlohmann::json::array();
  for (std::size_t rank = 0; rank < kRanksDrawn; ++rank) {
    curve.push_back({{"rank", rank + 1},
                     {"piles", good[rank].all_n},
                     {"good", number(good[rank].value())},
                     {"lifts_free", number(lifted[rank].value())}});
  }
  return curve;
}

}  // namespace

Table grasps_table(const std::vector<JudgedPile>& piles) {
  Table table({"part", "piles", "first good %", "offered %", "first good, true poses %",
               "offered, true poses %", "AUC descending", "AUC ascending", "AUC lift", "grasps ms",
               "unchanged %", "times as fast"});
  std::map<std::string, std::vector<JudgedPile>> by_part;
  for (const JudgedPile& pile : piles) by_part[pile.pile.part->id].push_back(pile);
  for (const auto& [id, of_part] : by_part) table.add(row_of(id, of_part));
  table.add(row_of("all", piles));
  return table;
}

Table causes_table(Piles piles) {
  const auto seen = causes_of(piles, &JudgedPile::descending);
  const auto known = causes_of(piles, &JudgedPile::from_truth);
  std::map<std::string, std::pair<int, int>> causes;
  for (const auto& [cause, count] : seen) causes[cause].first = count;
  for (const auto& [cause, count] : known) causes[cause].second = count;
  Table table({"first grasp", "piles", "piles, true poses"});
  for (const auto& [cause, counts] : causes) {
    table.add({cause, std::to_string(counts.first), std::to_string(counts.second)});
  }
  return table;
}

Table grasp_records(Piles piles) {
  Table records({"part", "seed", "parts_in_pile", "camera_height_m", "camera_tilt_rad", "plan",
                 "rank", "object", "cause", "pose_right", "lifts_free", "good_grasp_exists"});
  for (const JudgedPile& judged : piles) {
    const Pile& pile = judged.pile;
    for (const auto& [name, plan] :
         {std::pair("descending", &judged.descending), std::pair("ascending", &judged.ascending),
          std::pair("true_poses", &judged.from_truth)}) {
      for (std::size_t i = 0; i < plan->grasps.size(); ++i) {
        const JudgedGrasp& grasp = plan->grasps[i];
        records.add(
            {pile.part->id, std::to_string(pile.scene.seed), std::to_string(judged.scored.size()),
             fmt::format("{}", pile.scene.camera_height_m),
             fmt::format("{:.3f}", pile.scene.camera_tilt_rad), name, std::to_string(i + 1),
             std::to_string(grasp.object_id), grasp.cause, fmt::format("{:d}", grasp.is_pose_right),
             fmt::format("{:d}", grasp.lifts_free),
             judged.has_good_grasp ? fmt::format("{:d}", *judged.has_good_grasp) : ""});
      }
    }
  }
  return records;
}

nlohmann::json grasps_figures(Piles piles) {
  const Unchanged unchanged = unchanged_of(piles);
  const auto unknown_n = std::ranges::count_if(
      piles, [](const JudgedPile& pile) { return !pile.has_good_grasp.has_value(); });
  return {{"piles", piles.size()},
          {"first_grasp_good", number(first_grasp_good(piles, &JudgedPile::descending).value())},
          {"first_grasp_good_true_poses",
           number(first_grasp_good(piles, &JudgedPile::from_truth).value())},
          {"offered_where_exists",
           number(offered_where_exists(piles, &JudgedPile::descending).value())},
          {"offered_where_exists_true_poses",
           number(offered_where_exists(piles, &JudgedPile::from_truth).value())},
          {"searches_given_up", unknown_n},
          {"grasp_stage_ms", number(grasp_stage_ms(piles))},
          {"grs_rank_auc_descending", number(rank_auc(piles, &JudgedPile::descending))},
          {"grs_rank_auc_ascending", number(rank_auc(piles, &JudgedPile::ascending))},
          {"grs_lift_auc", number(lift_auc(piles))},
          {"unchanged_share", number(unchanged.answered.value())},
          {"unchanged_ms", number(unchanged.unchanged_ms)},
          {"unchanged_anew_ms", number(unchanged.anew_ms)},
          {"unchanged_speedup", number(unchanged.speedup)},
          {"unchanged_saved_ms", number(unchanged.saved_ms)},
          {"first_grasp_causes", causes_of(piles, &JudgedPile::descending)},
          {"first_grasp_causes_true_poses", causes_of(piles, &JudgedPile::from_truth)}};
}

nlohmann::json grasps_plot(Piles piles) {
  return {{"descending", curve_of(piles, &JudgedPile::descending)},
          {"ascending", curve_of(piles, &JudgedPile::ascending)}};
}

}  // namespace graspd::bench
