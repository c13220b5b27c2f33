#include "graspd/console/console.hpp"

#include <fmt/format.h>

#include <atomic>
#include <thread>

#include "cells.hpp"
#include "flight_files.hpp"
#include "graspd/codec/codec.hpp"
#include "part_shapes.hpp"
#include "watcher.hpp"

// After Eigen: a header below it defines `_res`, which Eigen has as a name.
#include <httplib.h>

namespace graspd::console {
namespace {

using nlohmann::json;
using std::chrono::milliseconds;

constexpr int kMostStreams_n = 24;
// Each stream holds one for as long as its page is open.
constexpr std::size_t kThreads_n = kMostStreams_n + 8;
// A browser that hears nothing for longer knows that there is nobody.
constexpr milliseconds kHeartbeat{2000};
// Between two messages of a stream: what changes faster is seen at this pace.
constexpr milliseconds kPace{20};

constexpr const char* kContentSecurityPolicy =
    "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' data: blob:; "
    "connect-src 'self'; base-uri 'none'; form-action 'none'; frame-ancestors 'none'";

// httplib's own would set SO_REUSEPORT, with which a second console takes half of the connections.
void set_socket_options(socket_t socket) {
  const int yes = 1;
  setsockopt(socket, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes);
}

std::string host_of(const std::string& host_and_port) {
  const std::size_t colon = host_and_port.rfind(':');
  const bool has_port =
      colon != std::string::npos && host_and_port.find(']', colon) == std::string::npos;
  return has_port ? host_and_port.substr(0, colon) : host_and_port;
}

std::string servers_json(const std::vector<client::ServerHealth>& servers) {
  std::string text;
  for (const client::ServerHealth& server : servers) {
    const json endpoint = server.endpoint;
    if (!text.empty()) text += ',';
    if (server.health) {
      text += fmt::format(R"({{"endpoint":{},"health":{}}})", endpoint.dump(),
                          codec::to_json(*server.health, false));
    } else {
      const json error = server.health.error().message;
      text += fmt::format(R"({{"endpoint":{},"error":{}}})", endpoint.dump(),
                          error.dump(-1, ' ', false, json::error_handler_t::replace));
    }
  }
  return '[' + text + ']';
}

void answer(const Result<std::string>& content, const char* type, httplib::Response& response) {
  if (content) {
    response.set_content(*content, type);
  } else {
    response.status = 404;
    response.set_content(content.error().message + "\n", "text/plain; charset=utf-8");
  }
}

}  // namespace

bool is_loopback(const std::string& host) {
  return host == "localhost" || host == "::1" || host == "[::1]" || host.starts_with("127.");
}

class Console::Impl {
 public:
  explicit Impl(ConsoleOptions options)
      : options_(std::move(options)), watcher_(options_.flights, options_.records, cells_) {
    server_.new_task_queue = [] { return new httplib::ThreadPool(kThreads_n); };
    server_.set_socket_options(set_socket_options);
    server_.set_keep_alive_timeout(2);
    server_.set_keep_alive_max_count(1000);
    server_.set_read_timeout(2);
    server_.set_write_timeout(5);
    server_.set_tcp_nodelay(true);
    server_.set_payload_max_length(1024);
    server_.set_default_headers({{"Content-Security-Policy", kContentSecurityPolicy},
                                 {"X-Content-Type-Options", "nosniff"},
                                 {"Referrer-Policy", "no-referrer"},
                                 {"Cross-Origin-Resource-Policy", "same-origin"},
                                 {"Cache-Control", "no-cache"}});
    server_.set_file_extension_and_mimetype_mapping("js", "text/javascript; charset=utf-8");
    add_pages();
  }
  Impl(const Impl&) = delete;
  Impl& operator=(const Impl&) = delete;
  ~Impl() {
    stop_ = true;
    cells_.wake();
    server_.stop();
    if (listener_.joinable()) listener_.join();
    if (asker_.joinable()) asker_.join();
  }

  Result<void> start() {
    if (!server_.set_mount_point("/", options_.page.string())) {
      return invalid("{}: the console's page is not there", options_.page.string());
    }
    const int port = options_.port == 0 ? server_.bind_to_any_port(options_.host)
                     : server_.bind_to_port(options_.host, options_.port) ? options_.port
                                                                          : -1;
    if (port <= 0) {
      return invalid("{}:{} is in use, or not this machine's; say another with --listen",
                     options_.host, options_.port);
    }
    url_ = fmt::format("http://{}:{}/", options_.host, port);
    listener_ = std::thread([this] { server_.listen_after_bind(); });
    // Before that, stop() would do nothing.
    while (!server_.is_running()) std::this_thread::yield();
    if (options_.ask_servers) asker_ = std::thread([this] { ask_servers(); });
    return {};
  }
  const std::string& url() const { return url_; }

 private:
  void add_pages() {
    using httplib::Request;
    using httplib::Response;
    // Otherwise a page elsewhere could have its own host's name lead here, and read all of this.
    server_.set_pre_routing_handler([this](const Request& request, Response& response) {
      const bool is_ours =
          !is_loopback(options_.host) || is_loopback(host_of(request.get_header_value("Host")));
      if (is_ours) return httplib::Server::HandlerResponse::Unhandled;
      response.status = 403;
      response.set_content("This console answers to localhost alone.\n", "text/plain");
      return httplib::Server::HandlerResponse::Handled;
    });
    server_.Get("/api/events", [this](const Request&, Response& response) { stream(response); });
    server_.Get("/api/history", [this](const Request& request, Response& response) {
      response.set_content(cells_.history(request.get_param_value("cell")), "application/json");
    });
    server_.Get("/api/flight", [this](const Request& request, Response& response) {
      answer(flight_file(request).and_then(flight_json), "application/json", response);
    });
    server_.Get("/api/depth", [this](const Request& request, Response& response) {
      answer(flight_file(request).and_then(flight_depth), "application/octet-stream", response);
    });
    server_.Get("/api/part", [this](const Request& request, Response& response) {
      answer(part_triangles(options_.parts, request.get_param_value("id")),
             "application/octet-stream", response);
    });
  }

  Result<std::filesystem::path> flight_file(const httplib::Request& request) const {
    return find_flight(options_.flights, request.get_param_value("name"));
  }

  void stream(httplib::Response& response) {
    if (++streams_n_ > kMostStreams_n) {
      --streams_n_;
      response.status = 503;
      response.set_content(
          fmt::format("{} pages are open on this console, and that is all it serves.\n",
                      kMostStreams_n),
          "text/plain");
      return;
    }
    response.set_chunked_content_provider(
        "text/event-stream",
        [this, seen = std::uint64_t{0}](std::size_t, httplib::DataSink& sink) mutable {
          std::string text = "event: alive\ndata: {}\n\n";
          for (const Event& event : cells_.changes_since(seen, kHeartbeat)) {
            text += fmt::format("event: {}\ndata: {}\n\n", event.name, event.data);
          }
          if (stop_ || !sink.write(text.data(), text.size())) return false;
          std::this_thread::sleep_for(kPace);
          return true;
        },
        [this](bool) { --streams_n_; });
  }

  void ask_servers() {
    while (!stop_) {
      if (streams_n_ > 0) cells_.set_servers(servers_json(options_.ask_servers()));
      for (int i = 0; i < 10 && !stop_; ++i) std::this_thread::sleep_for(milliseconds(100));
    }
  }

  ConsoleOptions options_;
  Cells cells_;
  Watcher watcher_;
  httplib::Server server_;
  std::string url_;
  std::atomic<int> streams_n_ = 0;
  std::atomic<bool> stop_ = false;
  std::thread listener_;
  std::thread asker_;
};

Result<Console> Console::start(ConsoleOptions options) {
  auto impl = std::make_unique<Impl>(std::move(options));
  if (auto ok = impl->start(); !ok) return tl::unexpected(ok.error());
  return Console(std::move(impl));
}

Console::Console(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
Console::Console(Console&&) noexcept = default;
Console& Console::operator=(Console&&) noexcept = default;
Console::~Console() = default;
const std::string& Console::url() const { return impl_->url(); }

}  // namespace graspd::console
