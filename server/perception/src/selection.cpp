#include "selection.hpp"

#include <algorithm>
#include <numeric>
#include <utility>

namespace graspd::perception {
namespace {

/// What a reading costs that a candidate shares, over what it gains by one of its own.
constexpr float kSharedCost = 1.3F;
constexpr int kMaxRounds = 4;

/// The candidates at each cell.
class CandidatesByCell {
 public:
  CandidatesByCell(std::span<const Candidate> candidates, std::size_t cells_n)
      : first_(cells_n + 1, 0) {
    for (const Candidate& candidate : candidates) {
      for (const std::uint32_t cell : candidate.cells) ++first_[cell + 1];
    }
    std::partial_sum(first_.begin(), first_.end(), first_.begin());
    indices_.resize(first_.back());
    std::vector<std::uint32_t> next(first_.begin(), first_.end() - 1);
    for (std::uint32_t i = 0; i < candidates.size(); ++i) {
      for (const std::uint32_t cell : candidates[i].cells) indices_[next[cell]++] = i;
    }
  }

  std::span<const std::uint32_t> at(std::size_t cell) const {
    return std::span(indices_).subspan(first_[cell], first_[cell + 1] - first_[cell]);
  }

 private:
  std::vector<std::uint32_t> first_, indices_;
};

class Selection {
 public:
  Selection(std::span<const Candidate> candidates, std::size_t cells_n)
      : candidates_(candidates),
        by_cell_(candidates, cells_n),
        explained_n_(cells_n, 0),
        is_chosen_(candidates.size(), false) {}

  std::vector<std::uint32_t> choose() {
    std::vector<std::uint32_t> all(candidates_.size());
    std::iota(all.begin(), all.end(), 0U);
    add_best_of(all);
    for (int round = 0; round < kMaxRounds && explain_otherwise(all); ++round) add_best_of(all);
    std::sort(chosen_.begin(), chosen_.end());
    return chosen_;
  }

 private:
  /// What is explained more with a candidate that is not chosen than without it.
  float gain_m2(std::uint32_t index) const {
    const Candidate& candidate = candidates_[index];
    const auto is_there_already = [&](std::uint32_t other) {
      return is_same_place(candidate.place, candidates_[other].place);
    };
    if (std::any_of(chosen_.begin(), chosen_.end(), is_there_already)) return 0;
    const auto shared_n = std::count_if(candidate.cells.begin(), candidate.cells.end(),
                                        [&](std::uint32_t cell) { return explained_n_[cell] > 0; });
    return candidate.area_m2 - kSharedCost * static_cast<float>(shared_n) * candidate.cell_m2;
  }

  void add(std::uint32_t index) {
    is_chosen_[index] = true;
    chosen_.push_back(index);
    for (const std::uint32_t cell : candidates_[index].cells) ++explained_n_[cell];
  }

  void remove(std::uint32_t index) {
    is_chosen_[index] = false;
    std::erase(chosen_, index);
    for (const std::uint32_t cell : candidates_[index].cells) --explained_n_[cell];
  }

  /// Adds of `some` always what gains most, until nothing does: `added_`.
  /// \returns what that gains together.
  float add_best_of(std::span<const std::uint32_t> some) {
    // Gains only fall while others are added, so that the first of the queue is the best as soon
    // as it is up to date.
    auto& queue = queue_;
    queue.clear();
    for (const std::uint32_t i : some) {
      if (!is_chosen_[i]) queue.emplace_back(candidates_[i].area_m2, i);
    }
    const auto comes_later = [](const auto& a, const auto& b) {
      return a.first != b.first ? a.first < b.first : a.second > b.second;
    };
    std::make_heap(queue.begin(), queue.end(), comes_later);
    added_.clear();
    float gain_sum_m2 = 0;
    while (!queue.empty()) {
      std::pop_heap(queue.begin(), queue.end(), comes_later);
      const auto [before_m2, i] = queue.back();
      queue.pop_back();
      const float now_m2 = gain_m2(i);
      if (now_m2 <= 0) continue;
      if (now_m2 < before_m2) {
        queue.emplace_back(now_m2, i);
        std::push_heap(queue.begin(), queue.end(), comes_later);
        continue;
      }
      add(i);
      gain_sum_m2 += now_m2;
      added_.push_back(i);
    }
    return gain_sum_m2;
  }

  /// \returns whether any of the chosen gave way to others.
  bool explain_otherwise(std::span<const std::uint32_t> all) {
    bool is_better = false;
    for (const std::uint32_t i : all) {
      if (is_chosen_[i]) is_better |= replace(i);
    }
    return is_better;
  }

  bool replace(std::uint32_t index) {
    auto& rivals = rivals_;
    rivals.clear();
    for (const std::uint32_t cell : candidates_[index].cells) {
      for (const std::uint32_t rival : by_cell_.at(cell)) {
        if (!is_chosen_[rival]) rivals.push_back(rival);
      }
    }
    std::sort(rivals.begin(), rivals.end());
    rivals.erase(std::unique(rivals.begin(), rivals.end()), rivals.end());

    remove(index);
    const float own_m2 = gain_m2(index);
    if (add_best_of(rivals) > own_m2) return true;
    for (const std::uint32_t rival : added_) remove(rival);
    add(index);
    return false;
  }

  std::span<const Candidate> candidates_;
  CandidatesByCell by_cell_;
  std::vector<std::uint16_t> explained_n_;  ///< by so many of the chosen, of each cell
  std::vector<bool> is_chosen_;
  std::vector<std::uint32_t> chosen_;
  // Working memory.
  std::vector<std::pair<float, std::uint32_t>> queue_;
  std::vector<std::uint32_t> added_, rivals_;
};

}  // namespace

std::vector<std::uint32_t> choose_explanation(std::span<const Candidate> candidates,
                                              std::size_t cells_n) {
  return Selection(candidates, cells_n).choose();
}

}  // namespace graspd::perception
