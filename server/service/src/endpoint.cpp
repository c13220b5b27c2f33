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

bool Endpoint::is_local() const {
  if (!path.empty() || host == "localhost" || host == "[::1]") return true;
  // A number, not a name that looks like one.
  return host.starts_with("127.") && host.find_first_not_of("0123456789.") == std::string::npos;
}

Result<Endpoint> parse_endpoint(std::string_view text) {
  constexpr std::string_view kTcp = "tcp://";
  constexpr std::string_view kIpc = "ipc://";
  if (text.starts_with(kIpc) && text.size() > kIpc.size()) {
    return Endpoint{"", "", std::string(text.substr(kIpc.size()))};
  }
  const std::size_t colon = text.rfind(':');
  if (text.starts_with(kTcp) && colon != std::string_view::npos && colon > kTcp.size()) {
    const std::string_view host = text.substr(kTcp.size(), colon - kTcp.size());
    const std::string_view port = text.substr(colon + 1);
    if (is_port(port)) return Endpoint{std::string(host), std::string(port), ""};
  }
  return invalid(
      "'{}' is no endpoint; it reads tcp://HOST:PORT, as in tcp://127.0.0.1:5555, or ipc://PATH "
      "for this machine alone",
      text);
}

}  // namespace graspd::service
