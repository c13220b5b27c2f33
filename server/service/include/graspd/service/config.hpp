#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

#include "graspd/perception/parameters.hpp"
#include "graspd/service/log.hpp"
#include "graspd/types/result.hpp"

namespace graspd::service {

/// `kFailed`: what ended INTERNAL or DEADLINE_EXCEEDED, and what asks to be recorded.
enum class FlightsKept { kFailed, kAll };

/// Where the last requests of each cell are kept, and how many.
struct FlightRecorderConfig {
  std::filesystem::path folder;  ///< empty: keep nothing; relative to the file that says it
  FlightsKept keep = FlightsKept::kFailed;
  std::uint32_t per_cell_n = 100;
  std::uint32_t max_mib = 1024;  ///< in all
};

/// What `grasp_server serve` can be told. deploy/server.yaml documents every key.
struct ServerConfig {
  std::string data_endpoint = "tcp://127.0.0.1:5555";
  std::string control_endpoint = "tcp://127.0.0.1:5556";
  bool insecure = false;                  ///< everybody on this machine may ask; keys are not used
  std::filesystem::path key_file;         ///< the server's own; relative to the file that says it
  std::filesystem::path allowed_cells;    ///< likewise
  std::filesystem::path parts = "parts";  ///< relative to the file that says it
  std::uint32_t workers_n = 2;            ///< 0: plan in the front's process
  std::uint32_t worker_threads_n = 0;     ///< 0: cores / workers
  std::uint32_t worker_memory_limit_mib = 2048;
  std::uint32_t worker_time_limit_ms = 30'000;
  std::uint32_t drain_limit_ms = 10'000;
  LogLevel log_level = LogLevel::kInfo;
  FlightRecorderConfig flight_recorder;
  std::string http_endpoint;  ///< tcp://HOST:PORT; empty: no HTTP
  bool http_expose = false;   ///< HTTP may listen beyond this machine
  perception::Parameters perception;
};

/// \returns INVALID_ARGUMENT with one line per fault, each with file and line. What has been read
/// is not yet validated, so that a command line may change it first.
Result<ServerConfig> read_config(const std::filesystem::path& path);

/// The rules that hold between values: endpoints, numbers in range, who may listen where.
Result<void> validate(const ServerConfig& config);

/// The whole effective configuration, defaults included, as `read_config` reads it.
std::string to_yaml(const ServerConfig& config);

/// Of what can change an answer: the perception section, and nothing of endpoints or workers, so
/// that all replicas of one service agree. XXH3-64 of its YAML text, in hexadecimal.
std::string config_hash(const perception::Parameters& parameters);

}  // namespace graspd::service

template <>
struct graspd::EnumNames<graspd::service::FlightsKept> {
  using Kept = service::FlightsKept;
  static constexpr std::string_view what = "choice of flights to keep";
  static constexpr std::pair<Kept, std::string_view> values[] = {{Kept::kFailed, "failed"},
                                                                 {Kept::kAll, "all"}};
};
