#include "graspd/service/endpoint.hpp"

#include <charconv>

namespace graspd::service {
namespace {

bool is_port(std::string_view text) {
  if (text == "*") return true;
  unsigned port = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), port);
  return error == std::errc() && end == text.data() + text.size() && port <= 65535;
}

}  // namespace

bool TcpEndpoint::is_loopback() const {
  return host == "localhost" || host == "[::1]" || host.starts_with("127.");
}

Result<TcpEndpoint> parse_endpoint(std::string_view text) {
  constexpr std::string_view kScheme = "tcp://";
  const std::size_t colon = text.rfind(':');
  if (text.starts_with(kScheme) && colon != std::string_view::npos && colon > kScheme.size()) {
    const std::string_view host = text.substr(kScheme.size(), colon - kScheme.size());
    const std::string_view port = text.substr(colon + 1);
    if (is_port(port)) return TcpEndpoint{std::string(host), std::string(port)};
  }
  return invalid("'{}' is no endpoint; it reads tcp://HOST:PORT, as in tcp://127.0.0.1:5555", text);
}

}  // namespace graspd::service
