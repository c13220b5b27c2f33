#include "diff_report.hpp"

#include <fmt/format.h>

#include <cmath>

#include "graspd/formats/table.hpp"

namespace graspd::program {
namespace {

using recorded::AnswerDiff;
using recorded::GraspChange;

std::string text_of(const Result<PlanAnswer>& answer) {
  if (!answer) return fmt::format("{} ({})", name_of(answer.error().code), answer.error().message);
  const std::size_t n = answer->grasps.size();
  return fmt::format("{}, {} grasp{}", name_of(answer->outcome), n, n == 1 ? "" : "s");
}

std::string rank_of(const GraspChange& change) {
  if (!change.new_rank) return fmt::format("{} → gone", *change.old_rank);
  if (!change.old_rank) return fmt::format("new → {}", *change.new_rank);
  return fmt::format("{} → {}", *change.old_rank, *change.new_rank);
}

std::string table_of(const std::vector<GraspChange>& changes) {
  Table table({"rank", "part", "pick point", "moved mm", "turned °", "opening mm", "score"});
  for (const GraspChange& change : changes) {
    if (!change.new_rank || !change.old_rank) {
      const double score = change.new_rank ? change.new_score : change.old_score;
      table.add({rank_of(change), change.part_id, change.pick_point, "–", "–", "–",
                 fmt::format("{:.4g}", score)});
      continue;
    }
    table.add({rank_of(change), change.part_id, change.pick_point,
               fmt::format("{:.3g}", change.moved_m * 1e3),
               fmt::format("{:.3g}", change.turned_rad * 180 / M_PI),
               fmt::format("{:+.3g}", change.opened_m * 1e3),
               fmt::format("{:.4g} → {:.4g}", change.old_score, change.new_score)});
  }
  return table.to_text();
}

/// What differs between the servers that answered.
std::string servers_diff(const ServerInfo& before, const ServerInfo& now) {
  std::string text;
  const auto compare = [&](const char* what, const std::string& a, const std::string& b) {
    if (a != b) text += fmt::format("{}{} {}, now {}", text.empty() ? "" : "; ", what, a, b);
  };
  compare("build", before.build, now.build);
  compare("catalogue", before.catalogue_hash, now.catalogue_hash);
  compare("config", before.config_hash, now.config_hash);
  return text;
}

}  // namespace

std::string DiffReport::compare(const PlanAnswer& before, const PlanAnswer& now) {
  servers_ = servers_diff(before.server, now.server);
  const AnswerDiff diff = recorded::diff(before, now);
  if (diff.is_same()) {
    ++same_n_;
    return "the same to the bit\n";
  }
  ++differ_n_;
  const std::string since = diff.since ? std::string(name_of(*diff.since)) : "the last words";
  ++differ_since_n_[since];
  std::string text = fmt::format("differs since {}: {}", since, diff.what);
  if (before.outcome != now.outcome) text += fmt::format("; was {}", name_of(before.outcome));
  return text + "\n" + (diff.grasps.empty() ? "" : table_of(diff.grasps));
}

std::string DiffReport::add(const std::string& name,
                            const std::optional<Result<PlanAnswer>>& before,
                            const Result<PlanAnswer>& now) {
  ++asked_n_;
  const std::string line = fmt::format("{:<12} {}", name, text_of(now));
  if (!now) {
    ++failed_n_;
    failure_ = now.error();
  }
  if (!before) return line + "\n";
  if (!*before) {
    ++failed_before_n_;
    return fmt::format("{}; was {}\n", line, text_of(*before));
  }
  if (!now) {
    ++differ_n_;
    ++differ_since_n_[std::string(name_of(now.error().code))];
    return fmt::format("{}; was {}\n", line, text_of(*before));
  }
  return line + "; " + compare(**before, *now);
}

std::string DiffReport::summary() const {
  std::string text = fmt::format("{} answer{}", asked_n_, asked_n_ == 1 ? "" : "s");
  if (failed_n_ > 0) text += fmt::format(", {} failed", failed_n_);
  if (failed_before_n_ > 0) text += fmt::format(", {} had failed before", failed_before_n_);
  if (same_n_ > 0) text += fmt::format(", {} the same to the bit", same_n_);
  if (differ_n_ > 0) text += fmt::format(", {} differ", differ_n_);
  std::string stages;
  for (const auto& [stage, n] : differ_since_n_) {
    stages += fmt::format("{}{} since {}", stages.empty() ? " (" : ", ", n, stage);
  }
  text += stages.empty() ? "\n" : stages + ")\n";
  if (!servers_.empty()) text += fmt::format("another server: {}\n", servers_);
  return text;
}

}  // namespace graspd::program
