#include <arpa/inet.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <stdexcept>
#include <thread>

#include "trial_servers.hpp"

namespace graspd::trials {
namespace {

using std::chrono::milliseconds;

/// What a peer says before it says nothing any more: of ZMTP 3.0 the greeting, that it is a DEALER,
/// and the first kilobyte of a frame of 100.
std::string begin_of_a_message() {
  std::string bytes("\xff\0\0\0\0\0\0\0\x01\x7f\x03\0NULL", 16);
  bytes.resize(64, '\0');
  bytes += std::string(
      "\x04\x1c\x05READY\x0bSocket-Type\0\0\0\x06"
      "DEALER",
      30);
  bytes += std::string("\x03\0\0\0\0\0\x01\x90\0", 9);
  return bytes + std::string(1024, 'x');
}

/// Peers that connect, say `words` and then nothing; again when they are thrown out.
class CrowdOfPeers {
 public:
  CrowdOfPeers(const std::string& endpoint, int peers_n, std::string words)
      : port_(static_cast<std::uint16_t>(std::stoi(endpoint.substr(endpoint.rfind(':') + 1)))),
        words_(std::move(words)),
        peers_(static_cast<std::size_t>(peers_n), pollfd{-1, POLLIN | POLLRDHUP, 0}) {
    for (pollfd& peer : peers_) connect_again(peer);
    thread_ = std::thread([this] {
      while (!stop_) tend();
    });
  }
  ~CrowdOfPeers() {
    stop_ = true;
    thread_.join();
    for (const pollfd& peer : peers_) close(peer.fd);
  }
  CrowdOfPeers(const CrowdOfPeers&) = delete;
  CrowdOfPeers& operator=(const CrowdOfPeers&) = delete;

 private:
  void connect_again(pollfd& peer) {
    if (peer.fd >= 0) close(peer.fd);
    peer.fd = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    address.sin_port = htons(port_);
    if (connect(peer.fd, reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0) {
      throw std::runtime_error("a peer of the crowd can't connect; is 'ulimit -n' too low?");
    }
    (void)send(peer.fd, words_.data(), words_.size(), MSG_NOSIGNAL);
  }
  void tend() {
    poll(peers_.data(), peers_.size(), 100);
    for (pollfd& peer : peers_) {
      char told[256];
      if ((peer.revents & POLLIN) != 0) (void)recv(peer.fd, told, sizeof told, MSG_DONTWAIT);
      if ((peer.revents & (POLLRDHUP | POLLHUP | POLLERR)) != 0) connect_again(peer);
    }
  }

  std::uint16_t port_;
  std::string words_;
  std::vector<pollfd> peers_;
  std::atomic<bool> stop_ = false;
  std::thread thread_;
};

}  // namespace

Crowd beside_a_crowd(CrowdKind kind, int peers_n, std::size_t requests_n) {
  const auto server = start_server(2);
  const LoadOptions options = cells_of({server->data_endpoint}, 1);
  Crowd seen;
  {
    History history;
    ClosedLoop load(options, history);
    history.wait_for(requests_n);
    load.stop();
    seen.alone_p99_ms = seen_in(history).p99_ms;
  }
  const std::size_t before_n = descriptors_n(server->pid());
  const CrowdOfPeers crowd(server->data_endpoint, peers_n,
                           kind == CrowdKind::kStalled ? begin_of_a_message() : "");
  History history;
  ClosedLoop load(options, history);
  for (int part = 0; part < 10; ++part) {
    history.wait_for(requests_n / 10);
    seen.connected_n = std::max(seen.connected_n, descriptors_n(server->pid()) - before_n);
  }
  load.stop();
  static_cast<Seen&>(seen) = seen_in(history);
  return seen;
}

}  // namespace graspd::trials
