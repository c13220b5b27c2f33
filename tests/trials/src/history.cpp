#include "graspd/trials/history.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace graspd::trials {
namespace {

double ms(Clock::duration duration) {
  return std::chrono::duration<double, std::milli>(duration).count();
}

}  // namespace

int Tally::ok_n() const { return static_cast<int>(ok_ms.size()); }

double Tally::quantile_ms(double share) const {
  if (ok_ms.empty()) return 0;
  const auto last = static_cast<double>(ok_ms.size() - 1);
  return ok_ms[static_cast<std::size_t>(std::lround(share * last))];
}

void History::asked(const RequestId& id, std::uint32_t question, TimePoint at,
                    std::chrono::milliseconds budget) {
  const std::lock_guard lock(mutex_);
  asked_.insert({id, {question, at, budget}});
}

void History::answered(const RequestId& id, TimePoint at, std::uint32_t question,
                       std::uint64_t digest) {
  end({id, at, Code::kOk, question, digest});
}

void History::refused(const RequestId& id, TimePoint at, Code code) { end({id, at, code}); }

void History::end(const End& end) {
  const std::lock_guard lock(mutex_);
  ended_.push_back(end);
  changed_.notify_all();
}

std::vector<std::string> History::violations() const {
  const std::lock_guard lock(mutex_);
  std::vector<std::string> found;
  std::map<RequestId, int> ends_n;
  std::map<std::uint32_t, std::uint64_t> answers;
  for (const End& end : ended_) {
    const std::string id = hexadecimal(end.id);
    const auto question = asked_.find(end.id);
    if (question == asked_.end()) {
      found.push_back(fmt::format("{}: answered, but never asked", id));
      continue;
    }
    if (++ends_n[end.id] == 2) found.push_back(fmt::format("{}: ended twice", id));
    const auto& [number, at, budget] = question->second;
    if (end.at - at > budget + kSlack) {
      found.push_back(fmt::format("{}: ended with {} after {:.0f} ms; its budget was {} ms", id,
                                  name_of(end.code), ms(end.at - at), budget.count()));
    }
    if (end.code != Code::kOk) continue;
    if (end.question != number) {
      found.push_back(fmt::format("{}: asked question {}, got the answer to question {}", id,
                                  number, end.question));
      continue;
    }
    const auto [answer, is_first] = answers.try_emplace(number, end.digest);
    if (!is_first && answer->second != end.digest) {
      found.push_back(fmt::format("{}: question {} has had another answer before", id, number));
    }
  }
  for (auto it = asked_.begin(); it != asked_.end(); it = asked_.upper_bound(it->first)) {
    const std::string id = hexadecimal(it->first);
    if (asked_.count(it->first) > 1) found.push_back(fmt::format("{}: asked twice", id));
    if (!ends_n.contains(it->first)) found.push_back(fmt::format("{}: never ended", id));
  }
  return found;
}

Tally History::tally() const {
  const std::lock_guard lock(mutex_);
  Tally tally;
  tally.asked_n = static_cast<int>(asked_.size());
  for (const End& end : ended_) {
    ++tally.ended_n[end.code];
    const auto question = asked_.find(end.id);
    if (end.code == Code::kOk && question != asked_.end()) {
      tally.ok_ms.push_back(ms(end.at - question->second.at));
    }
  }
  std::sort(tally.ok_ms.begin(), tally.ok_ms.end());
  return tally;
}

void History::wait_for(std::size_t requests_n) const {
  std::unique_lock lock(mutex_);
  const std::size_t until_n = ended_.size() + requests_n;
  changed_.wait(lock, [&] { return ended_.size() >= until_n; });
}

}  // namespace graspd::trials
