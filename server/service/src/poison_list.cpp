#include "poison_list.hpp"

namespace graspd::service {

bool PoisonList::add_death(std::uint64_t content) {
  const auto [found, is_new] = deaths_n_.try_emplace(content, 0);
  ++found->second;
  if (is_new) oldest_first_.push_back(content);
  if (oldest_first_.size() > kMost_n) {
    deaths_n_.erase(oldest_first_.front());
    oldest_first_.pop_front();
  }
  return contains(content);
}

bool PoisonList::contains(std::uint64_t content) const {
  const auto found = deaths_n_.find(content);
  return found != deaths_n_.end() && found->second >= kDeaths_n;
}

}  // namespace graspd::service
