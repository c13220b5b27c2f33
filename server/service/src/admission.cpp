#include "graspd/service/admission.hpp"

#include <algorithm>
#include <stdexcept>

namespace graspd::service {
namespace {

using std::chrono::duration_cast;
using std::chrono::milliseconds;
using std::chrono::nanoseconds;

// Weight of the newest measurement: about the last ten requests count.
constexpr double kNewest = 0.1;

std::vector<Ticket> tickets_of(const std::vector<Waiting>& requests) {
  std::vector<Ticket> tickets;
  for (const Waiting& request : requests) tickets.push_back(request.ticket);
  return tickets;
}

}  // namespace

Admission::Admission(std::size_t workers_n, std::uint64_t seed)
    : workers_n_(workers_n), queue_(kDepthPerCell, workers_n), random_(seed) {
  if (workers_n == 0) throw std::invalid_argument("Admission: no workers");
}

Admission::Verdict Admission::admit(Waiting request, TimePoint now) {
  if (request.deadline <= now) {
    return {Refusal{{Code::kDeadlineExceeded,
                     "no time was left of the request's budget when it arrived; give it more"},
                    0},
            std::nullopt};
  }
  const nanoseconds wait = predicted_wait(request.cell);
  if (now + wait > request.deadline) {
    std::uniform_real_distribution<double> jitter(0.75, 1.25);
    const double wait_ms = std::chrono::duration<double, std::milli>(wait).count();
    const auto retry_after_ms =
        static_cast<std::uint32_t>(std::max(1.0, wait_ms * jitter(random_)));
    const auto left_ms = duration_cast<milliseconds>(request.deadline - now).count();
    return {Refusal{{Code::kBusy, fmt::format("{} requests are ahead, about {:.0f} ms of waiting, "
                                              "and the request's budget ends in {} ms; retry after "
                                              "{} ms or on another server",
                                              queue_.ahead_of(request.cell) + running_.size(),
                                              wait_ms, left_ms, retry_after_ms)},
                    retry_after_ms},
            std::nullopt};
  }
  const std::optional<Waiting> superseded = queue_.push(std::move(request));
  return {std::nullopt, superseded ? std::optional(superseded->ticket) : std::nullopt};
}

std::optional<Ticket> Admission::start(TimePoint now) {
  std::optional<Waiting> next = queue_.start();
  if (!next) return std::nullopt;
  running_.emplace(next->ticket, Running{std::move(next->cell), now});
  return next->ticket;
}

void Admission::finish(Ticket ticket, TimePoint now, bool computed) {
  const auto found = running_.find(ticket);
  if (found == running_.end()) throw std::logic_error("Admission: this ticket is not running");
  if (computed) {
    const nanoseconds taken = now - found->second.started;
    const nanoseconds mean = mean_service_time_.value_or(taken);
    mean_service_time_ = mean + duration_cast<nanoseconds>(kNewest * (taken - mean));
  }
  queue_.finish(found->second.cell);
  running_.erase(found);
}

std::vector<Ticket> Admission::expire(TimePoint now) { return tickets_of(queue_.expire(now)); }

std::vector<Ticket> Admission::clear() { return tickets_of(queue_.clear()); }

nanoseconds Admission::predicted_wait(const std::string& cell) const {
  const std::size_t ahead = queue_.ahead_of(cell) + running_.size();
  if (ahead < workers_n_ || !mean_service_time_) return nanoseconds::zero();
  return *mean_service_time_ * ahead / workers_n_;
}

}  // namespace graspd::service
