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

/// What the server counts, for Prometheus; each series says in its HELP what it is.
///
/// A label's value is never what a client sent: a cell that is not on the allow-list counts as
/// "other", parts are the catalogue's, and everything else comes from lists in the code. So the
/// number of series is known beforehand, whatever clients do.
///
/// All members may be called from any thread at once.
class Metrics {
 public:
  /// \param cells whose names may be labels
  Metrics(const ServerInfo& server, const std::vector<std::string>& part_ids,
          const std::vector<std::string>& cells);
  ~Metrics();
  Metrics(const Metrics&) = delete;
  Metrics& operator=(const Metrics&) = delete;

  /// A request has got its answer.
  void answered(std::string_view cell, Code code, std::chrono::nanoseconds taken);
  /// A worker has planned.
  void planned(Outcome outcome, const std::vector<std::string>& part_ids,
               const std::vector<StageTiming>& timings);
  void worker_lost();
  void set_load(const Load& load);

  /// The text exposition format.
  std::string text() const;
  std::vector<CodeCount> answers_by_code() const;
  std::vector<StageTotal> stages() const;
  std::uint64_t workers_lost_n() const;

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace graspd::service
