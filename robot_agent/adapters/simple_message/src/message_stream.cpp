#include "message_stream.hpp"

#include <fcntl.h>
#include <netdb.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <memory>
#include <system_error>
#include <utility>

namespace graspd::simple_message {
namespace {

using std::chrono::milliseconds;
using std::chrono::steady_clock;

std::string what_failed(int error) { return std::generic_category().message(error); }

/// Whether the socket is ready for `events` before `until`.
bool wait_for(int socket, short events, steady_clock::time_point until) {
  while (true) {
    const auto left = std::chrono::ceil<milliseconds>(until - steady_clock::now());
    pollfd waited{socket, events, 0};
    const int ready_n = poll(&waited, 1, static_cast<int>(std::max(left, milliseconds(0)).count()));
    if (ready_n >= 0 || errno != EINTR) return ready_n > 0;
  }
}

using Addresses = std::unique_ptr<addrinfo, decltype(&freeaddrinfo)>;

Result<Addresses> resolve(const std::string& host, std::uint16_t port) {
  addrinfo hints{};
  hints.ai_socktype = SOCK_STREAM;
  addrinfo* found = nullptr;
  const int error = getaddrinfo(host.c_str(), std::to_string(port).c_str(), &hints, &found);
  if (error != 0) {
    return fail(Code::kUnavailable, "there is no host '{}': {}", host, gai_strerror(error));
  }
  return Addresses(found, &freeaddrinfo);
}

/// 0, or why the socket, which does not block, could not be connected.
int connect_error(int socket, const addrinfo& address, steady_clock::time_point until) {
  if (::connect(socket, address.ai_addr, address.ai_addrlen) == 0) return 0;
  if (errno != EINPROGRESS) return errno;
  if (!wait_for(socket, POLLOUT, until)) return ETIMEDOUT;
  int error = 0;
  socklen_t size = sizeof(error);
  getsockopt(socket, SOL_SOCKET, SO_ERROR, &error, &size);
  return error;
}

}  // namespace

Result<MessageStream> MessageStream::connect(const std::string& host, std::uint16_t port,
                                             milliseconds timeout) {
  const auto addresses = resolve(host, port);
  if (!addresses) return tl::unexpected(addresses.error());
  const auto until = steady_clock::now() + timeout;
  const addrinfo& address = **addresses;
  MessageStream stream(socket(address.ai_family, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0),
                       fmt::format("{}:{}", host, port));
  if (const int error = connect_error(stream.socket_, address, until)) {
    return fail(Code::kUnavailable, "no connection to the controller at {}: {}", stream.name_,
                what_failed(error));
  }
  const int on = 1;
  setsockopt(stream.socket_, IPPROTO_TCP, TCP_NODELAY, &on, sizeof(on));
  return stream;
}

MessageStream::MessageStream(MessageStream&& other) noexcept
    : socket_(std::exchange(other.socket_, -1)),
      name_(std::move(other.name_)),
      received_(std::move(other.received_)) {}

MessageStream& MessageStream::operator=(MessageStream&& other) noexcept {
  std::swap(socket_, other.socket_);
  std::swap(name_, other.name_);
  std::swap(received_, other.received_);
  return *this;
}

MessageStream::~MessageStream() {
  if (socket_ >= 0) close(socket_);
}

Result<void> MessageStream::send(const Message& message, milliseconds timeout) {
  const std::vector<std::byte> bytes = to_bytes(message);
  const auto until = steady_clock::now() + timeout;
  for (std::size_t sent = 0; sent < bytes.size();) {
    const auto n = ::send(socket_, bytes.data() + sent, bytes.size() - sent, MSG_NOSIGNAL);
    if (n > 0) {
      sent += static_cast<std::size_t>(n);
    } else if (errno == EAGAIN) {
      if (!wait_for(socket_, POLLOUT, until)) {
        return fail(Code::kUnavailable, "{} takes no bytes", name_);
      }
    } else if (errno != EINTR) {
      return fail(Code::kUnavailable, "the connection to {} broke: {}", name_, what_failed(errno));
    }
  }
  return {};
}

Result<std::optional<Message>> MessageStream::next(milliseconds timeout) {
  const auto until = steady_clock::now() + timeout;
  while (true) {
    auto message = take_message(received_);
    if (!message) return invalid("{} sends {}", name_, message.error().message);
    if (*message) return message;
    if (!wait_for(socket_, POLLIN, until)) return std::nullopt;
    std::array<std::byte, 4096> bytes;
    const auto n = recv(socket_, bytes.data(), bytes.size(), 0);
    if (n > 0) {
      received_.insert(received_.end(), bytes.begin(), bytes.begin() + n);
    } else if (n == 0) {
      return fail(Code::kUnavailable, "{} closed the connection", name_);
    } else if (errno != EINTR && errno != EAGAIN) {
      return fail(Code::kUnavailable, "the connection to {} broke: {}", name_, what_failed(errno));
    }
  }
}

void MessageStream::shut_down() { shutdown(socket_, SHUT_RDWR); }

}  // namespace graspd::simple_message
