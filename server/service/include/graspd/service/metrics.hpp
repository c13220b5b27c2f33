#pragma once

#include <chrono>
#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "graspd/types/answer.hpp"
#include "graspd/types/envelope.hpp"

namespace graspd::service {

/// How busy the server is at one moment.
struct Load {
  std::size_t queued_n = 0;
  std::size_t workers_ready_n = 0;
  std::size_t workers_busy_n = 0;
  std::uint64_t front_memory_bytes = 0;
  std::uint64_t workers_memory_bytes = 0;
  bool ready = false;
  bool draining = false;
};

/// Why somebody was not let in.
enum class AuthFailure {
  kUnknownKey,  ///< a connection: its key is not on the allow-list
  kRevokedKey,  ///< a message: its key is not on the allow-list any more
  kWrongCell,   ///< a request in the name of another cell than its key's
};

/// What the server counts, for Prometheus; each series says in its HELP what it is.
///
/// A label's value is never what a client sent: a cell that is not on the allow-list counts as
/// "other", parts are the catalogue's, and everything else comes from lists in the code. So the
/// number of series is known beforehand, whatever clients do.
///
/// All members may be called from any thread at once.
class Metrics {
 public:
  Metrics(const ServerInfo& server, const std::vector<std::string>& part_ids);
  ~Metrics();
  Metrics(const Metrics&) = delete;
  Metrics& operator=(const Metrics&) = delete;

  /// Other parts are served from now on.
  void serve(const ServerInfo& server, const std::vector<std::string>& part_ids);
  /// A cell of the allow-list: its name is a label from now on, even if it leaves the list, since a
  /// series that goes would look like a restart.
  void know(const std::string& cell);

  /// A request has got its answer.
  void answered(std::string_view cell, Code code, std::chrono::nanoseconds taken);
  /// A worker has planned.
  void planned(Outcome outcome, const std::vector<std::string>& part_ids,
               const std::vector<StageTiming>& timings);
  /// One has died, or was ended for hanging.
  void worker_lost();
  void auth_failed(AuthFailure why, std::size_t times_n = 1);
  /// In the place of what was set before.
  void set_load(const Load& load);

  /// The text exposition format.
  std::string text() const;
  /// Of plan requests, since the start.
  std::vector<CodeCount> answers_by_code() const;
  std::vector<StageTotal> stages() const;
  std::uint64_t workers_lost_n() const;

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace graspd::service

template <>
struct graspd::EnumNames<graspd::service::AuthFailure> {
  using Why = service::AuthFailure;
  static constexpr std::string_view what = "failure of authentication";
  static constexpr std::pair<Why, std::string_view> values[] = {{Why::kUnknownKey, "unknown_key"},
                                                                {Why::kRevokedKey, "revoked_key"},
                                                                {Why::kWrongCell, "wrong_cell"}};
};
