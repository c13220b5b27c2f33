#include "graspd/trials/chaos_proxy.hpp"

#include <arpa/inet.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/eventfd.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cerrno>
#include <deque>
#include <list>
#include <mutex>
#include <optional>
#include <random>
#include <stdexcept>
#include <thread>
#include <utility>
#include <vector>

namespace graspd::trials {
namespace {

using Clock = std::chrono::steady_clock;
using TimePoint = Clock::time_point;

// What is on its way in one direction; a sender that is faster waits, as TCP has it.
constexpr std::size_t kMostHeld_bytes = std::size_t{4} << 20;

sockaddr_in loopback(std::uint16_t port) {
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  address.sin_port = htons(port);
  return address;
}

class Socket {
 public:
  explicit Socket(int fd) : fd_(fd) {}
  ~Socket() {
    if (fd_ >= 0) close(fd_);
  }
  Socket(Socket&& other) noexcept : fd_(std::exchange(other.fd_, -1)) {}
  Socket& operator=(Socket&&) = delete;
  int fd() const { return fd_; }

  void close_with_reset() const {
    const linger at_once{1, 0};
    setsockopt(fd_, SOL_SOCKET, SO_LINGER, &at_once, sizeof at_once);
  }

 private:
  int fd_;
};

Socket new_socket() {
  Socket made(socket(AF_INET, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0));
  if (made.fd() < 0) throw std::runtime_error("chaos proxy: no socket");
  const int one = 1;  // or the kernel would glue together again what is chopped
  setsockopt(made.fd(), IPPROTO_TCP, TCP_NODELAY, &one, sizeof one);
  return made;
}

/// One direction of one connection.
class Pipe {
 public:
  bool wants_more() const { return open_ && held_bytes_ < kMostHeld_bytes; }
  bool is_due(TimePoint now) const { return !chunks_.empty() && chunks_.front().due <= now; }
  TimePoint due() const { return chunks_.empty() ? TimePoint::max() : chunks_.front().due; }
  bool is_over() const { return !open_ && chunks_.empty(); }

  /// \returns false where the connection is broken.
  bool read_from(int fd, const Chaos& chaos, std::mt19937_64& random) {
    std::array<char, 65536> buffer;
    const ssize_t n = recv(fd, buffer.data(), buffer.size(), 0);
    if (n < 0) return errno == EAGAIN;
    if (n == 0) {
      open_ = false;
      return true;
    }
    Chunk chunk{Clock::now() + chaos.delay, {buffer.data(), buffer.data() + n}};
    if (std::bernoulli_distribution(chaos.corrupt_share)(random)) {
      const std::size_t bit = random() % (chunk.bytes.size() * 8);
      chunk.bytes[bit / 8] = static_cast<char>(chunk.bytes[bit / 8] ^ (1 << bit % 8));
    }
    held_bytes_ += chunk.bytes.size();
    chunks_.push_back(std::move(chunk));
    return true;
  }

  /// \returns how many bytes have left; nothing where the connection is broken.
  std::optional<std::size_t> write_to(int fd, const Chaos& chaos) {
    Chunk& chunk = chunks_.front();
    std::size_t n = chunk.bytes.size() - written_;
    if (chaos.chop_bytes > 0) n = std::min(n, chaos.chop_bytes);
    const ssize_t sent = send(fd, chunk.bytes.data() + written_, n, MSG_NOSIGNAL);
    if (sent < 0) return errno == EAGAIN ? std::optional<std::size_t>(0) : std::nullopt;
    written_ += static_cast<std::size_t>(sent);
    if (written_ == chunk.bytes.size()) {
      held_bytes_ -= chunk.bytes.size();
      chunks_.pop_front();
      written_ = 0;
    }
    return static_cast<std::size_t>(sent);
  }

 private:
  struct Chunk {
    TimePoint due;
    std::vector<char> bytes;
  };
  std::deque<Chunk> chunks_;
  std::size_t written_ = 0;  ///< of the first chunk
  std::size_t held_bytes_ = 0;
  bool open_ = true;
};

struct Connection {
  Socket client;
  Socket server;
  Pipe up{};
  Pipe down{};

  void reset() const {
    client.close_with_reset();
    server.close_with_reset();
  }
};

}  // namespace

class ChaosProxy::Impl {
 public:
  Impl(std::uint16_t target_port, std::uint64_t seed)
      : target_port_(target_port),
        listener_(new_socket()),
        wake_(eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK)),
        random_(seed) {
    sockaddr_in address = loopback(0);
    auto* any = reinterpret_cast<sockaddr*>(&address);
    socklen_t size = sizeof address;
    if (bind(listener_.fd(), any, size) != 0 || listen(listener_.fd(), 128) != 0 ||
        getsockname(listener_.fd(), any, &size) != 0) {
      throw std::runtime_error("chaos proxy: no port on loopback");
    }
    port_ = ntohs(address.sin_port);
    thread_ = std::thread([this] { run(); });
  }
  ~Impl() {
    stop_ = true;
    wake();
    thread_.join();
  }

  void set(const Chaos& chaos) {
    {
      const std::lock_guard lock(mutex_);
      chaos_ = chaos;
    }
    wake();
  }
  void reset_connections() {
    {
      const std::lock_guard lock(mutex_);
      for (const Connection& connection : connections_) connection.reset();
      connections_.clear();
    }
    wake();  // a socket that is polled is not closed before the poll's end
  }

  std::uint16_t port() const { return port_; }
  std::size_t connections_n() const {
    const std::lock_guard lock(mutex_);
    return connections_.size();
  }
  std::uint64_t passed_bytes() const {
    const std::lock_guard lock(mutex_);
    return passed_bytes_;
  }

 private:
  void wake() const { eventfd_write(wake_.fd(), 1); }

  void run() {
    while (!stop_) {
      wait();
      // What was told before a byte came is in force when it is read.
      const std::lock_guard lock(mutex_);
      accept_all();
      if (!chaos_.stalled) carry();
    }
  }

  void wait() {
    std::vector<pollfd> items{{wake_.fd(), POLLIN, 0}, {listener_.fd(), POLLIN, 0}};
    TimePoint until = TimePoint::max();
    const TimePoint now = Clock::now();
    std::unique_lock lock(mutex_);
    const auto add = [&](const Socket& socket, const Pipe& in, const Pipe& out) {
      const int events = (in.wants_more() ? POLLIN : 0) | (out.is_due(now) ? POLLOUT : 0);
      if (!out.is_due(now)) until = std::min(until, out.due());
      if (events != 0) items.push_back({socket.fd(), static_cast<short>(events), 0});
    };
    if (!chaos_.stalled) {
      for (const Connection& connection : connections_) {
        add(connection.client, connection.up, connection.down);
        add(connection.server, connection.down, connection.up);
      }
    }
    lock.unlock();
    const auto left = std::chrono::ceil<std::chrono::milliseconds>(until - now).count();
    poll(items.data(), items.size(), until == TimePoint::max() ? -1 : static_cast<int>(left));
    eventfd_t ignored = 0;
    eventfd_read(wake_.fd(), &ignored);
  }

  void accept_all() {
    while (true) {
      Socket client(accept4(listener_.fd(), nullptr, nullptr, SOCK_NONBLOCK | SOCK_CLOEXEC));
      if (client.fd() < 0) return;
      const int one = 1;
      setsockopt(client.fd(), IPPROTO_TCP, TCP_NODELAY, &one, sizeof one);
      Socket server = new_socket();
      const sockaddr_in address = loopback(target_port_);
      const int done =
          connect(server.fd(), reinterpret_cast<const sockaddr*>(&address), sizeof address);
      if (done != 0 && errno != EINPROGRESS) continue;
      connections_.push_back({std::move(client), std::move(server)});
    }
  }

  void carry() {
    connections_.remove_if([&](Connection& connection) {
      const bool alive = carry(connection.client, connection.up, connection.server) &&
                         carry(connection.server, connection.down, connection.client);
      if (!alive) connection.reset();
      return !alive || connection.up.is_over() || connection.down.is_over();
    });
  }

  /// \returns false where the connection is broken.
  bool carry(const Socket& from, Pipe& pipe, const Socket& to) {
    // Not connected yet is no end: reading says ENOTCONN then.
    if (pipe.wants_more() && !pipe.read_from(from.fd(), chaos_, random_) && errno != ENOTCONN) {
      return false;
    }
    if (!pipe.is_due(Clock::now())) return true;
    const auto sent = pipe.write_to(to.fd(), chaos_);
    if (!sent) return errno == ENOTCONN;
    passed_bytes_ += *sent;
    return true;
  }

  std::uint16_t target_port_;
  Socket listener_;
  Socket wake_;
  std::uint16_t port_ = 0;
  std::mt19937_64 random_;
  std::atomic<bool> stop_ = false;
  mutable std::mutex mutex_;  ///< of all that follows
  Chaos chaos_;
  std::list<Connection> connections_;
  std::uint64_t passed_bytes_ = 0;
  std::thread thread_;
};

ChaosProxy::ChaosProxy(const std::string& target, std::uint64_t seed)
    : impl_(std::make_unique<Impl>(
          static_cast<std::uint16_t>(std::stoi(target.substr(target.rfind(':') + 1))), seed)) {}
ChaosProxy::~ChaosProxy() = default;
std::string ChaosProxy::endpoint() const {
  return "tcp://127.0.0.1:" + std::to_string(impl_->port());
}
void ChaosProxy::set(const Chaos& chaos) { impl_->set(chaos); }
void ChaosProxy::reset_connections() { impl_->reset_connections(); }
std::size_t ChaosProxy::connections_n() const { return impl_->connections_n(); }
std::uint64_t ChaosProxy::passed_bytes() const { return impl_->passed_bytes(); }

}  // namespace graspd::trials
