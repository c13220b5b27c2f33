#include "graspd/client/dispatcher.hpp"

#include <algorithm>
#include <tuple>

namespace graspd::client {
namespace {

using std::chrono::milliseconds;

constexpr double kRetryTokens = 10;
constexpr double kRetryTokensPerCall = 0.1;
constexpr milliseconds kBackOff{50};
constexpr milliseconds kDrainingHold{1000};
constexpr milliseconds kFullSocketHold{20};
constexpr milliseconds kFirstQuarantine{2000};
constexpr milliseconds kLastQuarantine{32'000};

}  // namespace

Dispatcher::Dispatcher(const std::vector<std::string>& endpoints, DispatchOptions options,
                       std::uint64_t seed)
    : options_(options), retry_tokens_(kRetryTokens), random_(seed) {
  for (const std::string& endpoint : endpoints) add_server(endpoint);
  asked_n_ = std::uint64_t{1} << 32;
}

std::size_t Dispatcher::add_server(const std::string& endpoint) {
  auto found = std::ranges::find(servers_, Server::State::kGone, &Server::state);
  if (found == servers_.end()) {
    servers_.emplace_back();
    found = servers_.end() - 1;
    for (Call& call : calls_) call.tried.push_back(false);
  }
  *found = Server{};
  found->endpoint = endpoint;
  found->last_asked = random_() >> 32;
  const auto index = static_cast<std::size_t>(found - servers_.begin());
  for (Call& call : calls_) call.tried[index] = false;
  return index;
}

void Dispatcher::retire(std::size_t server) { servers_[server].state = Server::State::kRetiring; }

void Dispatcher::keep(std::size_t server) { servers_[server].state = Server::State::kInUse; }

std::vector<std::size_t> Dispatcher::take_gone() {
  std::vector<std::size_t> gone;
  for (std::size_t index = 0; index < servers_.size(); ++index) {
    Server& server = servers_[index];
    const bool is_asked = server.in_flight_n > 0 || std::ranges::any_of(calls_, [&](const Call& c) {
                            return c.only == index;
                          });
    if (server.state != Server::State::kRetiring || is_asked) continue;
    server = Server{};
    server.state = Server::State::kGone;
    gone.push_back(index);
  }
  return gone;
}

void Dispatcher::add(const RequestId& id, TimePoint now, TimePoint deadline,
                     std::optional<std::size_t> only) {
  Call call;
  call.id = id;
  call.deadline = deadline;
  call.only = only;
  call.not_before = now;
  call.connect_until = now + options_.connect_timeout;
  call.tried.resize(servers_.size());
  calls_.push_back(std::move(call));
  retry_tokens_ = std::min(kRetryTokens, retry_tokens_ + kRetryTokensPerCall);
}

void Dispatcher::connected(std::size_t server) {
  servers_[server].connected = true;
  servers_[server].silences_n = 0;
  servers_[server].refusal.reset();
}

void Dispatcher::disconnected(std::size_t server, TimePoint now) {
  lose(server,
       {Code::kUnavailable,
        fmt::format("the connection to {} was lost before it answered; is grasp_server "
                    "still running there?",
                    servers_[server].endpoint)},
       now);
}

void Dispatcher::refused(std::size_t server, const Error& why, TimePoint now) {
  servers_[server].refusal = why;
  lose(server, why, now);
}

void Dispatcher::lose(std::size_t server, const Error& why, TimePoint now) {
  servers_[server].connected = false;
  for (Call& call : calls_) {
    if (call.server != server) continue;
    land(call);
    call.connect_until = now + options_.connect_timeout;
    retry_later(call, now, why);
    call.costs_token = false;
  }
}

std::optional<Result<Answer>> Dispatcher::answered(std::size_t server, Answer answer,
                                                   TimePoint now) {
  servers_[server].silences_n = 0;
  const auto found = find(answer.id);
  if (found == calls_.end()) return std::nullopt;
  Call& call = *found;
  const bool current = call.server == server;
  // An attempt that was given up may still bring the answer, but no longer a refusal.
  if (!current && answer.code != Code::kOk) return std::nullopt;
  land(call);
  const bool shed = answer.code == Code::kBusy || answer.code == Code::kDraining;
  if (shed) {
    const milliseconds hold =
        answer.code == Code::kBusy ? milliseconds(answer.retry_after_ms) : kDrainingHold;
    servers_[server].hold_until = std::max(servers_[server].hold_until, now + hold);
    retry_later(call, now, {answer.code, std::move(answer.message)});
    return std::nullopt;
  }
  calls_.erase(found);
  if (answer.code != Code::kOk) return fail(answer.code, "{}", answer.message);
  return answer;
}

void Dispatcher::not_sent(const RequestId& id, TimePoint now) {
  Call& call = *find(id);
  servers_[*call.server].hold_until = now + kFullSocketHold;
  land(call);
  --call.attempts_n;
  if (call.costs_token) retry_tokens_ += 1;
}

Dispatcher::Step Dispatcher::step(TimePoint now) {
  Step step;
  for (auto it = calls_.begin(); it != calls_.end();) {
    Call& call = *it;
    if (std::optional<Error> error = verdict(call, now)) {
      land(call);
      step.failed.push_back({call.id, std::move(*error)});
      it = calls_.erase(it);
      continue;
    }
    if (!call.server && now >= call.not_before) {
      if (const auto server = choose(call, now)) {
        step.attempts.push_back(launch(call, *server, now));
      }
    }
    step.wake = std::min(step.wake, wake_of(call, now));
    ++it;
  }
  return step;
}

std::list<Dispatcher::Call>::iterator Dispatcher::find(const RequestId& id) {
  return std::find_if(calls_.begin(), calls_.end(),
                      [&](const Call& call) { return call.id == id; });
}

/// Ends the attempt in flight, if there is one.
void Dispatcher::land(Call& call) {
  if (!call.server) return;
  --servers_[*call.server].in_flight_n;
  call.server.reset();
}

void Dispatcher::retry_later(Call& call, TimePoint now, Error why) {
  call.last_error = std::move(why);
  call.costs_token = true;
  // Another server is asked at once; the same one after a pause that differs between clients.
  const bool untried = std::any_of(servers_.begin(), servers_.end(), [&](const Server& server) {
    const auto index = static_cast<std::size_t>(&server - servers_.data());
    return server.connected && may_use(call, index) && !call.tried[index];
  });
  std::uniform_real_distribution<double> jitter(0.5, 1.5);
  const milliseconds pause =
      untried ? milliseconds(0)
              : std::chrono::duration_cast<milliseconds>(
                    kBackOff * (1 << std::min(call.attempts_n, 5u)) / 2 * jitter(random_));
  call.not_before = now + pause;
}

/// Whether the call has failed for good. Gives up an attempt that took too long.
std::optional<Error> Dispatcher::verdict(Call& call, TimePoint now) {
  if (call.server && now >= end_of_attempt(call)) {
    const std::string& endpoint = servers_[*call.server].endpoint;
    quarantine(servers_[*call.server], now);
    land(call);
    retry_later(
        call, now,
        {Code::kDeadlineExceeded,
         fmt::format("{} did not answer in time; give the call a larger budget", endpoint)});
  }
  if (call.server) return std::nullopt;
  if (now >= call.deadline) return call.last_error.value_or(unavailable(call));
  if (call.attempts_n > 0) {
    const bool no_more = call.only || call.attempts_n >= options_.max_attempts_n;
    if (no_more || (call.costs_token && retry_tokens_ < 1)) {
      Error error = *call.last_error;
      if (call.attempts_n > 1) error.message += fmt::format(" ({} attempts)", call.attempts_n);
      return error;
    }
  }
  if (!any_connected(call)) {
    if (now < call.connect_until && !all_refuse(call)) return std::nullopt;
    return call.last_error.value_or(unavailable(call));
  }
  // Everybody asked to be left alone for longer than there is time.
  if (call.last_error && wake_of(call, now) >= call.deadline) return call.last_error;
  return std::nullopt;
}

/// A server that is connected but does not answer is asked last, for longer with each silence.
void Dispatcher::quarantine(Server& server, TimePoint now) {
  const milliseconds length = kFirstQuarantine * (1 << std::min(server.silences_n, 10u));
  server.quarantined_until = now + std::min(kLastQuarantine, length);
  ++server.silences_n;
}

std::optional<std::size_t> Dispatcher::choose(const Call& call, TimePoint now) const {
  std::optional<std::size_t> best;
  const auto rank = [&](std::size_t index) {
    const Server& server = servers_[index];
    // A server that was silent gets one call at a time, to show whether it still is.
    const bool suspect =
        server.silences_n > 0 && (now < server.quarantined_until || server.in_flight_n > 0);
    return std::make_tuple(static_cast<bool>(call.tried[index]), suspect, server.in_flight_n,
                           server.last_asked);
  };
  for (std::size_t index = 0; index < servers_.size(); ++index) {
    const Server& server = servers_[index];
    if (!server.connected || !may_use(call, index) || server.hold_until > now) continue;
    if (!best || rank(index) < rank(*best)) best = index;
  }
  return best;
}

Dispatcher::Attempt Dispatcher::launch(Call& call, std::size_t server, TimePoint now) {
  if (call.costs_token) retry_tokens_ -= 1;
  call.sent = now;
  call.server = server;
  call.tried[server] = true;
  servers_[server].last_asked = ++asked_n_;
  ++call.attempts_n;
  ++servers_[server].in_flight_n;
  return {call.id, server, call.attempts_n,
          std::chrono::ceil<milliseconds>(end_of_attempt(call) - now)};
}

/// When the attempt in flight is given up: later where there is nobody else to ask.
TimePoint Dispatcher::end_of_attempt(const Call& call) const {
  for (std::size_t index = 0; index < servers_.size(); ++index) {
    if (index != *call.server && servers_[index].connected && may_use(call, index)) {
      return std::min(call.deadline, call.sent + options_.attempt_timeout);
    }
  }
  return call.deadline;
}

bool Dispatcher::any_connected(const Call& call) const {
  for (std::size_t index = 0; index < servers_.size(); ++index) {
    if (servers_[index].connected && may_use(call, index)) return true;
  }
  return false;
}

bool Dispatcher::may_use(const Call& call, std::size_t server) const {
  if (call.only) return *call.only == server;
  return servers_[server].state == Server::State::kInUse;
}

TimePoint Dispatcher::wake_of(const Call& call, TimePoint now) const {
  if (call.server) return end_of_attempt(call);
  if (!any_connected(call)) return std::min(call.connect_until, call.deadline);
  TimePoint held = TimePoint::max();
  for (std::size_t index = 0; index < servers_.size(); ++index) {
    if (servers_[index].connected && may_use(call, index)) {
      held = std::min(held, servers_[index].hold_until);
    }
  }
  return std::min(call.deadline, std::max({now, held, call.not_before}));
}

/// Waiting for a connection is of no use.
bool Dispatcher::all_refuse(const Call& call) const {
  bool is_any = false;
  for (std::size_t index = 0; index < servers_.size(); ++index) {
    const auto& refusal = servers_[index].refusal;
    const bool for_good = refusal && refusal->code == Code::kUnauthenticated;
    if (may_use(call, index) && !for_good) return false;
    is_any = is_any || may_use(call, index);
  }
  return is_any;
}

/// Why there is nobody to ask. A refusal says more than silence.
Error Dispatcher::unavailable(const Call& call) const {
  if (no_server_) return *no_server_;
  for (std::size_t index = 0; index < servers_.size(); ++index) {
    if (may_use(call, index) && servers_[index].refusal) return *servers_[index].refusal;
  }
  std::string endpoints;
  for (std::size_t index = 0; index < servers_.size(); ++index) {
    if (!may_use(call, index)) continue;
    if (!endpoints.empty()) endpoints += ", ";
    endpoints += servers_[index].endpoint;
  }
  return {Code::kUnavailable,
          fmt::format("no server answers at {}; check that grasp_server runs there, and that "
                      "address and port are right",
                      endpoints)};
}

}  // namespace graspd::client
