#include "http_endpoint.hpp"

#include <fmt/format.h>

#include <thread>

#include "graspd/service/endpoint.hpp"
#include "graspd/service/front.hpp"

// After Eigen: a header below it defines `_res`, which Eigen has as a name.
#include <httplib.h>

namespace graspd::service {
namespace {

constexpr std::size_t kThreads_n = 4;

std::string address_of(const std::string& host) {
  return host.starts_with('[') ? host.substr(1, host.size() - 2) : host;
}

int port_of(const std::string& port) { return port == "*" ? 0 : std::stoi(port); }

// httplib's own would set SO_REUSEPORT, with which a second server takes half of the connections.
void set_socket_options(socket_t socket) {
  const int yes = 1;
  setsockopt(socket, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes);
}

void answer_check(const std::optional<std::string>& why_not, httplib::Response& response) {
  response.status = why_not ? 503 : 200;
  response.set_content(why_not.value_or("ok") + "\n", "text/plain; charset=utf-8");
}

}  // namespace

class HttpEndpoint::Impl {
 public:
  Impl(const std::string& endpoint, HttpPages pages) : pages_(std::move(pages)) {
    server_.new_task_queue = [] { return new httplib::ThreadPool(kThreads_n); };
    server_.set_socket_options(set_socket_options);
    // Whoever connects and says nothing holds a thread for a second, not longer.
    server_.set_keep_alive_max_count(1);
    server_.set_read_timeout(1);
    server_.set_write_timeout(1);
    server_.set_payload_max_length(1024);
    server_.Get("/metrics", [this](const httplib::Request&, httplib::Response& response) {
      response.set_content(pages_.metrics(), "text/plain; version=0.0.4; charset=utf-8");
    });
    server_.Get("/livez", [this](const httplib::Request&, httplib::Response& response) {
      answer_check(pages_.why_not_alive(), response);
    });
    server_.Get("/readyz", [this](const httplib::Request&, httplib::Response& response) {
      answer_check(pages_.why_not_ready(), response);
    });
    url_ = bind(endpoint);
    thread_ = std::thread([this] { server_.listen_after_bind(); });
    // Before that, stop() would do nothing.
    while (!server_.is_running()) std::this_thread::yield();
  }
  Impl(const Impl&) = delete;
  Impl& operator=(const Impl&) = delete;
  ~Impl() {
    server_.stop();
    thread_.join();
  }
  const std::string& url() const { return url_; }

 private:
  std::string bind(const std::string& endpoint) {
    const Endpoint parsed = parse_endpoint(endpoint).value();
    const std::string address = address_of(parsed.host == "*" ? "0.0.0.0" : parsed.host);
    int port = port_of(parsed.port);
    if (port == 0) {
      port = server_.bind_to_any_port(address);
    } else if (!server_.bind_to_port(address, port)) {
      port = -1;
    }
    if (port <= 0) {
      throw CannotListen(fmt::format(
          "http: endpoint: {} is in use, or not this machine's; say another port (0 takes a free "
          "one)",
          endpoint));
    }
    return fmt::format("http://{}:{}", parsed.host, port);
  }

  HttpPages pages_;
  httplib::Server server_;
  std::string url_;
  std::thread thread_;
};

HttpEndpoint::HttpEndpoint(const std::string& endpoint, HttpPages pages)
    : impl_(std::make_unique<Impl>(endpoint, std::move(pages))) {}
HttpEndpoint::~HttpEndpoint() = default;
const std::string& HttpEndpoint::url() const { return impl_->url(); }

}  // namespace graspd::service
