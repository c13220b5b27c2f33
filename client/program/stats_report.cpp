#include "stats_report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <functional>

#include "graspd/formats/table.hpp"

namespace graspd::program {
namespace {

using client::ServerHealth;

constexpr double kMiB = 1024.0 * 1024.0;
const std::vector<std::string> kColumns{"server",  "state",        "busy", "queued",
                                        "plans/s", "ok",           "shed", "refused",
                                        "broken",  "workers lost", "MiB",  "up s"};

/// What the same server said before; all zero where it has not, or was another process.
HealthAnswer earlier(const std::vector<ServerHealth>& before, const ServerHealth& now) {
  const auto found = std::find_if(before.begin(), before.end(), [&](const ServerHealth& server) {
    return server.endpoint == now.endpoint;
  });
  const bool is_same =
      found != before.end() && found->health && found->health->uptime_s <= now.health->uptime_s;
  return is_same ? *found->health : HealthAnswer{};
}

std::uint64_t answers_n(const HealthAnswer& health, const std::function<bool(Code)>& counts) {
  std::uint64_t sum = 0;
  for (const auto& [code, n] : health.answers_by_code) sum += counts(code) ? n : 0;
  return sum;
}

std::vector<std::string> row_of(const ServerHealth& server, const HealthAnswer& before) {
  const HealthAnswer& now = *server.health;
  const auto count = [&](const std::function<bool(Code)>& counts) {
    return answers_n(now, counts) - answers_n(before, counts);
  };
  const auto is_ok = [](Code code) { return code == Code::kOk; };
  const auto is_refused = [&](Code code) {
    return !is_ok(code) && !is_shed(code) && !is_broken(code);
  };
  const std::uint64_t ok_n = count(is_ok);
  const double time_s = now.uptime_s - before.uptime_s;
  return {server.endpoint,
          std::string(name_of(now.state)),
          fmt::format("{}/{}", now.workers_busy_n, now.workers_n),
          std::to_string(now.queued_n),
          time_s > 0 ? fmt::format("{:.1f}", static_cast<double>(ok_n) / time_s) : "–",
          std::to_string(ok_n),
          std::to_string(count(is_shed)),
          std::to_string(count(is_refused)),
          std::to_string(count(is_broken)),
          std::to_string(now.workers_lost_n - before.workers_lost_n),
          fmt::format("{:.0f}", static_cast<double>(now.memory_bytes) / kMiB),
          fmt::format("{:.0f}", now.uptime_s)};
}

/// Adds a server's stages to those of others, in the order they are run in.
void add_stages(const HealthAnswer& health, const HealthAnswer& before,
                std::vector<StageTotal>& sums) {
  const auto find = [](auto& totals, const std::string& stage) {
    return std::find_if(totals.begin(), totals.end(),
                        [&](const StageTotal& total) { return total.stage == stage; });
  };
  for (const StageTotal& now : health.stages) {
    auto sum = find(sums, now.stage);
    if (sum == sums.end()) sum = sums.insert(sums.end(), {now.stage, 0, 0});
    const auto then = find(before.stages, now.stage);
    const bool is_new = then == before.stages.end();
    sum->runs_n += now.runs_n - (is_new ? 0 : then->runs_n);
    sum->total_ns += now.total_ns - (is_new ? 0 : then->total_ns);
  }
}

std::string stages_table(const std::vector<StageTotal>& stages) {
  Table table({"stage", "runs", "mean ms"});
  bool any = false;
  for (const auto& [stage, runs_n, total_ns] : stages) {
    if (runs_n == 0) continue;
    any = true;
    const double mean_ms = static_cast<double>(total_ns) / 1e6 / static_cast<double>(runs_n);
    table.add({stage, std::to_string(runs_n), fmt::format("{:.2f}", mean_ms)});
  }
  return any ? "\n" + table.to_text() : "";
}

}  // namespace

std::string stats_report(const std::vector<ServerHealth>& before,
                         const std::vector<ServerHealth>& now) {
  Table servers(kColumns);
  std::vector<StageTotal> stages;
  for (const ServerHealth& server : now) {
    if (!server.health) {
      std::vector<std::string> row(kColumns.size(), "–");
      row[0] = server.endpoint;
      row[1] = name_of(server.health.error().code);
      servers.add(std::move(row));
      continue;
    }
    const HealthAnswer then = earlier(before, server);
    servers.add(row_of(server, then));
    add_stages(*server.health, then, stages);
  }
  return servers.to_text() + stages_table(stages);
}

}  // namespace graspd::program
