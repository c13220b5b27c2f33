#pragma once

#include <chrono>
#include <cstdint>
#include <list>
#include <optional>
#include <random>
#include <string>
#include <vector>

#include "graspd/types/envelope.hpp"

namespace graspd::client {

using Clock = std::chrono::steady_clock;
using TimePoint = Clock::time_point;

/// How long to wait for whom, and how often to try.
struct DispatchOptions {
  /// Where another server could be asked, how long to wait for one. With nobody else to ask, an
  /// attempt may take all of the budget that is left.
  std::chrono::milliseconds attempt_timeout{3000};
  /// How long a call waits for any server to be connected.
  std::chrono::milliseconds connect_timeout{1500};
  std::uint32_t max_attempts_n = 3;
};

/// Which server is asked next, and when a call has failed: the decisions of the Freelance pattern,
/// without its sockets. Servers are named by their index. Calls are sent in the order they came.
///
/// A call goes to the connected server with the fewest calls in flight; among equals to the one
/// that was asked longest ago, so that clients with one call at a time use all servers too. A
/// server that let an attempt's time pass is quarantined: asked only where there is nobody else,
/// and then by one call at a time, until it answers. Where an attempt gets no answer, is shed
/// (BUSY, DRAINING) or loses its connection, the next one goes to another server where there is
/// one. Retries after silence and shedding are at most a tenth of all calls in the long run, so
/// that clients don't bury servers that are in trouble. A lost connection is no such sign: it has
/// to be made again first, and a server does not compute twice at a time what it is asked again.
/// Not thread-safe; time comes in with each call.
class Dispatcher {
 public:
  Dispatcher(const std::vector<std::string>& endpoints, DispatchOptions options,
             std::uint64_t seed);

  /// \returns its index: a new one, or that of a server that is gone.
  std::size_t add_server(const std::string& endpoint);
  /// Asks it nothing new. It is gone when nothing is in flight to it any more.
  void retire(std::size_t server);
  /// It is not to be retired after all.
  void keep(std::size_t server);
  /// The retiring servers that are gone now.
  std::vector<std::size_t> take_gone();
  /// Why there is no server to wait for; nothing: there is one.
  void no_server(std::optional<Error> why) { no_server_ = std::move(why); }

  /// `only`: ask this server, once (health).
  void add(const RequestId& id, TimePoint now, TimePoint deadline,
           std::optional<std::size_t> only = std::nullopt);
  /// From now on it may be asked.
  void connected(std::size_t server);
  /// What it was asked is asked elsewhere, or again when it is back.
  void disconnected(std::size_t server, TimePoint now);
  /// The server does not take our key. Its calls go elsewhere; those that have nowhere else to go
  /// end with `why`.
  void refused(std::size_t server, const Error& why, TimePoint now);
  /// \returns the call's end, if this is it. Answers of calls that have ended are dropped.
  std::optional<Result<Answer>> answered(std::size_t server, Answer answer, TimePoint now);
  /// The socket took nothing: the attempt has not been one.
  void not_sent(const RequestId& id, TimePoint now);

  /// A request that is to be sent.
  struct Attempt {
    RequestId id{};
    std::size_t server = 0;
    std::uint32_t number = 1;
    std::chrono::milliseconds budget{0};
  };
  /// A call that ends without an answer.
  struct Failed {
    RequestId id{};
    Error error;
  };
  /// What is to be done now, and when to look again.
  struct Step {
    std::vector<Attempt> attempts;  ///< to be sent now
    std::vector<Failed> failed;
    TimePoint wake = TimePoint::max();
  };
  /// Everything that is due.
  Step step(TimePoint now);

 private:
  struct Server {
    std::string endpoint;
    enum class State { kInUse, kRetiring, kGone } state = State::kInUse;
    bool connected = false;
    std::size_t in_flight_n = 0;
    TimePoint hold_until;          ///< it asked to be left alone
    std::uint64_t last_asked = 0;  ///< the count of attempts at that time; at first random
    std::uint32_t silences_n = 0;  ///< attempts in a row that it did not answer in time
    TimePoint quarantined_until;
    std::optional<Error> refusal;  ///< of our key; until it is connected
  };
  struct Call {
    RequestId id{};
    TimePoint deadline;
    std::optional<std::size_t> only;
    std::uint32_t attempts_n = 0;
    bool costs_token = false;           ///< the next attempt does
    std::optional<std::size_t> server;  ///< while in flight
    TimePoint sent;                     ///< the attempt in flight
    TimePoint not_before;
    TimePoint connect_until;
    std::vector<bool> tried;
    std::optional<Error> last_error;
  };

  std::list<Call>::iterator find(const RequestId& id);
  void land(Call& call);
  void lose(std::size_t server, const Error& why, TimePoint now);
  void retry_later(Call& call, TimePoint now, Error why);
  std::optional<Error> verdict(Call& call, TimePoint now);
  static void quarantine(Server& server, TimePoint now);
  std::optional<std::size_t> choose(const Call& call, TimePoint now) const;
  Attempt launch(Call& call, std::size_t server, TimePoint now);
  TimePoint end_of_attempt(const Call& call) const;
  bool any_connected(const Call& call) const;
  bool may_use(const Call& call, std::size_t server) const;
  TimePoint wake_of(const Call& call, TimePoint now) const;
  bool all_refuse(const Call& call) const;
  Error unavailable(const Call& call) const;

  DispatchOptions options_;
  std::vector<Server> servers_;
  std::optional<Error> no_server_;
  std::list<Call> calls_;
  double retry_tokens_;
  std::uint64_t asked_n_ = 0;
  std::mt19937_64 random_;
};

}  // namespace graspd::client
