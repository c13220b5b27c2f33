#include "graspd/service/config.hpp"

#include <xxhash.h>

#include "graspd/formats/yaml.hpp"
#include "graspd/service/endpoint.hpp"
#include "graspd/service/parameters_yaml.hpp"

namespace graspd::service {
namespace {

Result<void> validate_endpoint(std::string_view key, const std::string& text, bool insecure) {
  const Result<Endpoint> endpoint = parse_endpoint(text);
  if (!endpoint) return invalid("{}: {}", key, endpoint.error().message);
  if (insecure && !endpoint->is_local()) {
    return invalid(
        "{}: {} can be reached from other machines, and 'insecure: true' lets everybody in; listen "
        "on 127.0.0.1, or take 'insecure' out and say key_file and allowed_cells",
        key, text);
  }
  return {};
}

Result<void> validate_keys(const ServerConfig& config) {
  const bool any = !config.key_file.empty() || !config.allowed_cells.empty();
  const bool both = !config.key_file.empty() && !config.allowed_cells.empty();
  if (config.insecure && any) {
    return invalid(
        "insecure: true lets everybody in, and {} is there to let in cells with a key; say one of "
        "the two",
        config.key_file.empty() ? "allowed_cells" : "key_file");
  }
  if (config.insecure || both) return {};
  return invalid(
      "{}: this server lets in nobody without a key; make its own with 'grasp keys new server' and "
      "say it as key_file (--key), make the list of cells with 'grasp keys allow' and say it as "
      "allowed_cells (--allowed-cells); or say 'insecure: true' (--insecure) on a machine that you "
      "share with nobody",
      any ? (config.key_file.empty() ? "key_file is missing" : "allowed_cells is missing")
          : "key_file and allowed_cells are missing");
}

Result<void> validate_range(std::string_view key, std::uint32_t value, std::uint32_t low,
                            std::uint32_t high) {
  if (value < low || value > high)
    return invalid("{}: {} is outside {} … {}", key, value, low, high);
  return {};
}

/// Metrics and health are nothing secret, but nobody's business either unless somebody says so.
Result<void> validate_http(const ServerConfig& config) {
  if (config.http_endpoint.empty()) return {};
  const Result<Endpoint> endpoint = parse_endpoint(config.http_endpoint);
  if (!endpoint) return invalid("http: endpoint: {}", endpoint.error().message);
  if (!endpoint->path.empty()) {
    return invalid("http: endpoint: {}: HTTP needs tcp://HOST:PORT", config.http_endpoint);
  }
  if (!endpoint->is_local() && !config.http_expose) {
    return invalid(
        "http: endpoint: {} can be reached from other machines; listen on 127.0.0.1, or say "
        "'expose: true' beside it where everybody may read the metrics",
        config.http_endpoint);
  }
  return {};
}

/// Paths in a file are relative to it.
void optional_path(YamlMap& map, const std::string& key, const std::filesystem::path& file,
                   std::filesystem::path& path) {
  std::string text = path;
  map.optional(key, text);
  path =
      text.empty() ? std::filesystem::path() : std::filesystem::absolute(file).parent_path() / text;
}

std::string quoted(const std::string& text) {
  YAML::Emitter emitter;
  emitter << YAML::DoubleQuoted << text;
  return emitter.c_str();
}

}  // namespace

Result<ServerConfig> read_config(const std::filesystem::path& path) {
  ServerConfig config;
  YamlDocument document(path);
  YamlMap root = document.root();
  root.optional("data_endpoint", config.data_endpoint);
  root.optional("control_endpoint", config.control_endpoint);
  root.optional("insecure", config.insecure);
  optional_path(root, "key_file", path, config.key_file);
  optional_path(root, "allowed_cells", path, config.allowed_cells);
  optional_path(root, "parts", path, config.parts);
  root.optional("workers_n", config.workers_n);
  root.optional("worker_threads_n", config.worker_threads_n);
  root.optional("worker_memory_limit_mib", config.worker_memory_limit_mib);
  root.optional("worker_time_limit_ms", config.worker_time_limit_ms);
  root.optional("drain_limit_ms", config.drain_limit_ms);
  root.optional_enum("log_level", config.log_level);
  YamlMap flights = root.map("flight_recorder");
  optional_path(flights, "folder", path, config.flight_recorder.folder);
  flights.optional_enum("keep", config.flight_recorder.keep);
  flights.optional("per_cell_n", config.flight_recorder.per_cell_n);
  flights.optional("max_mib", config.flight_recorder.max_mib);
  YamlMap http = root.map("http");
  http.optional("endpoint", config.http_endpoint);
  http.optional("expose", config.http_expose);
  read_parameters(root.map("perception"), config.perception);
  if (auto ok = document.finish(); !ok) return tl::unexpected(ok.error());
  return config;
}

Result<void> validate(const ServerConfig& config) {
  const std::pair<std::string_view, const std::string*> endpoints[] = {
      {"data_endpoint", &config.data_endpoint}, {"control_endpoint", &config.control_endpoint}};
  for (const auto& [key, endpoint] : endpoints) {
    if (auto ok = validate_endpoint(key, *endpoint, config.insecure); !ok) return ok;
  }
  if (auto ok = validate_keys(config); !ok) return ok;
  if (auto ok = validate_http(config); !ok) return ok;
  if (auto ok = validate_range("workers_n", config.workers_n, 0, 256); !ok) return ok;
  if (auto ok = validate_range("worker_threads_n", config.worker_threads_n, 0, 256); !ok) return ok;
  const std::uint32_t limit_mib = config.worker_memory_limit_mib;
  if (limit_mib != 0 && limit_mib < 128) {
    return invalid(
        "worker_memory_limit_mib: {} is too little to plan in; 0 means no limit, else "
        "at least 128",
        limit_mib);
  }
  if (auto ok = validate_range("worker_time_limit_ms", config.worker_time_limit_ms, 100, 3'600'000);
      !ok) {
    return ok;
  }
  const FlightRecorderConfig& flights = config.flight_recorder;
  if (auto ok = validate_range("flight_recorder: per_cell_n", flights.per_cell_n, 1, 100'000);
      !ok) {
    return ok;
  }
  return validate_range("flight_recorder: max_mib", flights.max_mib, 2, 1'000'000);
}

std::string to_yaml(const ServerConfig& config) {
  return fmt::format(
      "data_endpoint: {}\ncontrol_endpoint: {}\ninsecure: {}\nkey_file: {}\nallowed_cells: {}\n"
      "parts: {}\nworkers_n: {}\n"
      "worker_threads_n: {}\nworker_memory_limit_mib: {}\nworker_time_limit_ms: {}\n"
      "drain_limit_ms: {}\nlog_level: {}\n"
      "flight_recorder:\n  folder: {}\n  keep: {}\n  per_cell_n: {}\n  max_mib: {}\n"
      "http:\n  endpoint: {}\n  expose: {}\n"
      "perception:\n{}",
      quoted(config.data_endpoint), quoted(config.control_endpoint), config.insecure,
      quoted(config.key_file), quoted(config.allowed_cells), quoted(config.parts), config.workers_n,
      config.worker_threads_n, config.worker_memory_limit_mib, config.worker_time_limit_ms,
      config.drain_limit_ms, name_of(config.log_level), quoted(config.flight_recorder.folder),
      name_of(config.flight_recorder.keep), config.flight_recorder.per_cell_n,
      config.flight_recorder.max_mib, quoted(config.http_endpoint), config.http_expose,
      parameters_to_yaml(config.perception, 2));
}

std::string config_hash(const perception::Parameters& parameters) {
  const std::string text = parameters_to_yaml(parameters, 0);
  return fmt::format("{:016x}", XXH3_64bits(text.data(), text.size()));
}

}  // namespace graspd::service
