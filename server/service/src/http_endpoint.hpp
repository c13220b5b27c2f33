#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>

namespace graspd::service {

/// What HTTP asks. Called from its threads, all at once.
struct HttpPages {
  std::function<std::string()> metrics;
  /// Why not, as a sentence; nothing where the answer is yes.
  std::function<std::optional<std::string>()> why_not_alive;
  std::function<std::optional<std::string>()> why_not_ready;
};

/// /metrics for Prometheus; /livez and /readyz for whoever restarts servers and sends them
/// requests: 200, or 503 with a sentence. On threads of its own. Nothing secret is told, and nobody
/// is asked for a key.
class HttpEndpoint {
 public:
  /// \param endpoint tcp://HOST:PORT
  /// \throws CannotListen
  HttpEndpoint(const std::string& endpoint, HttpPages pages);
  ~HttpEndpoint();
  HttpEndpoint(const HttpEndpoint&) = delete;
  HttpEndpoint& operator=(const HttpEndpoint&) = delete;

  /// http://HOST:PORT
  const std::string& url() const;

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace graspd::service
