#include "graspd/service/fair_queue.hpp"

#include <algorithm>
#include <stdexcept>

namespace graspd::service {

FairQueue::FairQueue(std::size_t depth_per_cell, std::size_t workers_n)
    : depth_per_cell_(depth_per_cell), share_n_(std::max<std::size_t>(1, workers_n / 4)) {
  if (depth_per_cell == 0) throw std::invalid_argument("FairQueue: a depth of 0 holds nothing");
}

std::optional<Waiting> FairQueue::push(Waiting request) {
  Cell& cell = cells_[request.cell];
  std::optional<Waiting> superseded;
  if (cell.queue.size() == depth_per_cell_) {
    superseded = std::move(cell.queue.front());
    cell.queue.pop_front();
  } else if (cell.queue.empty()) {
    turns_.insert(turns_.begin() + static_cast<std::ptrdiff_t>(joining_turn(cell)), request.cell);
  }
  cell.queue.push_back(std::move(request));
  return superseded;
}

std::optional<Waiting> FairQueue::start() {
  if (turns_.empty()) return std::nullopt;
  auto turn = std::find_if(turns_.begin(), turns_.end(), [this](const std::string& cell) {
    return cells_.at(cell).running_n < share_n_;
  });
  // Where every waiting cell has its share already, an idle worker helps nobody.
  if (turn == turns_.end()) turn = turns_.begin();

  const std::string name = *turn;
  turns_.erase(turn);
  Cell& cell = cells_.at(name);
  Waiting next = std::move(cell.queue.front());
  cell.queue.pop_front();
  ++cell.running_n;
  if (!cell.queue.empty()) turns_.push_back(name);
  return next;
}

void FairQueue::finish(const std::string& cell) {
  const auto found = cells_.find(cell);
  if (found == cells_.end() || found->second.running_n == 0) {
    throw std::logic_error("FairQueue: cell '" + cell + "' has nothing running");
  }
  --found->second.running_n;
  forget_if_idle(cell);
}

std::vector<Waiting> FairQueue::expire(TimePoint now) {
  std::vector<Waiting> expired;
  const std::deque<std::string> turns = turns_;
  for (const std::string& name : turns) {
    std::deque<Waiting>& queue = cells_.at(name).queue;
    const auto late =
        std::stable_partition(queue.begin(), queue.end(),
                              [now](const Waiting& waiting) { return waiting.deadline > now; });
    std::move(late, queue.end(), std::back_inserter(expired));
    queue.erase(late, queue.end());
    if (queue.empty()) {
      std::erase(turns_, name);
      forget_if_idle(name);
    }
  }
  return expired;
}

std::vector<Waiting> FairQueue::clear() { return expire(TimePoint::max()); }

std::optional<TimePoint> FairQueue::earliest_deadline() const {
  std::optional<TimePoint> earliest;
  for (const std::string& name : turns_) {
    for (const Waiting& waiting : cells_.at(name).queue) {
      if (!earliest || waiting.deadline < *earliest) earliest = waiting.deadline;
    }
  }
  return earliest;
}

std::size_t FairQueue::queued_n() const {
  std::size_t sum = 0;
  for (const auto& [name, cell] : cells_) sum += cell.queue.size();
  return sum;
}

std::size_t FairQueue::running_n() const {
  std::size_t sum = 0;
  for (const auto& [name, cell] : cells_) sum += cell.running_n;
  return sum;
}

std::size_t FairQueue::ahead_of(const std::string& cell) const {
  const auto found = cells_.find(cell);
  const std::size_t queued = found == cells_.end() ? 0 : found->second.queue.size();
  const std::size_t own = std::min(queued, depth_per_cell_ - 1);  // a full queue loses its oldest
  // The new request starts in its cell's turn own + 1. Cells whose turn comes before have had one
  // turn more by then than those after.
  const auto waits = std::find(turns_.begin(), turns_.end(), cell);
  const std::size_t turn = waits != turns_.end()
                               ? static_cast<std::size_t>(waits - turns_.begin())
                               : joining_turn(found == cells_.end() ? Cell{} : found->second);
  std::size_t ahead = own;
  for (std::size_t i = 0; i < turns_.size(); ++i) {
    if (turns_[i] == cell) continue;
    ahead += std::min(cells_.at(turns_[i]).queue.size(), i < turn ? own + 1 : own);
  }
  return ahead;
}

/// Where a cell that waited for nothing gets its turn: at the end; but where nothing of its own
/// runs, before the cells at the end that have something running. They have had their turn while it
/// had none, and they are overtaken only as long as that runs.
std::size_t FairQueue::joining_turn(const Cell& cell) const {
  std::size_t turn = turns_.size();
  if (cell.running_n > 0) return turn;
  while (turn > 0 && cells_.at(turns_[turn - 1]).running_n > 0) --turn;
  return turn;
}

void FairQueue::forget_if_idle(const std::string& cell) {
  const auto found = cells_.find(cell);
  if (found->second.queue.empty() && found->second.running_n == 0) cells_.erase(found);
}

}  // namespace graspd::service
