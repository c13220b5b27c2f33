#include <arpa/inet.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <string>
#include <thread>

#include "graspd/trials/chaos_proxy.hpp"

// The proxy between two plain sockets: what is read on one side is what was written on the other,
// unless it was told otherwise.
namespace graspd::trials {
namespace {

using std::chrono::milliseconds;
using std::chrono::steady_clock;

sockaddr_in loopback(int port) {
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  address.sin_port = htons(static_cast<std::uint16_t>(port));
  return address;
}

class ChaosProxyTest : public ::testing::Test {
 protected:
  ChaosProxyTest()
      : listener_(listen_on_any()), proxy_("tcp://127.0.0.1:" + std::to_string(port_), 7) {
    const std::string endpoint = proxy_.endpoint();
    const sockaddr_in address = loopback(std::stoi(endpoint.substr(endpoint.rfind(':') + 1)));
    client_ = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
    if (connect(client_, reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0) {
      throw std::runtime_error("no way to the proxy");
    }
    server_ = accept4(listener_, nullptr, nullptr, SOCK_CLOEXEC);
  }
  ~ChaosProxyTest() override {
    for (const int fd : {client_, server_, listener_}) close(fd);
  }

  static void write_all(int fd, const std::string& text) {
    ASSERT_EQ(send(fd, text.data(), text.size(), MSG_NOSIGNAL), static_cast<ssize_t>(text.size()));
  }
  static std::string read_n(int fd, std::size_t n) {
    std::string text(n, '\0');
    const ssize_t got = recv(fd, text.data(), n, MSG_WAITALL);
    text.resize(static_cast<std::size_t>(std::max<ssize_t>(got, 0)));
    return text;
  }
  static bool is_readable(int fd) {
    char byte = 0;
    return recv(fd, &byte, 1, MSG_PEEK | MSG_DONTWAIT) == 1;
  }
  static std::string long_text() {
    std::string text;
    while (text.size() < 100'000) text += std::to_string(text.size()) + " ";
    return text;
  }

 private:
  int listen_on_any() {
    const int listener = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
    sockaddr_in address = loopback(0);
    socklen_t size = sizeof address;
    auto* any = reinterpret_cast<sockaddr*>(&address);
    if (bind(listener, any, size) != 0 || listen(listener, 4) != 0 ||
        getsockname(listener, any, &size) != 0) {
      throw std::runtime_error("no port on loopback");
    }
    port_ = ntohs(address.sin_port);
    return listener;
  }

  int port_ = 0;
  int listener_;

 protected:
  ChaosProxy proxy_;
  int client_ = -1;
  int server_ = -1;
};

TEST_F(ChaosProxyTest, PassesEverythingBothWays) {
  const std::string text = long_text();
  std::thread writer([&] { write_all(client_, text); });
  EXPECT_EQ(read_n(server_, text.size()), text);
  writer.join();
  write_all(server_, "back");
  EXPECT_EQ(read_n(client_, 4), "back");
  EXPECT_EQ(proxy_.connections_n(), 1u);
  EXPECT_EQ(proxy_.passed_bytes(), text.size() + 4);
}

TEST_F(ChaosProxyTest, DelaysEachWay) {
  proxy_.set({milliseconds(50)});
  const auto start = steady_clock::now();
  write_all(client_, "there");
  EXPECT_EQ(read_n(server_, 5), "there");
  EXPECT_GE(steady_clock::now() - start, milliseconds(50));
  write_all(server_, "back");
  EXPECT_EQ(read_n(client_, 4), "back");
  EXPECT_GE(steady_clock::now() - start, milliseconds(100));
}

TEST_F(ChaosProxyTest, ChopsAndLosesNothing) {
  proxy_.set({milliseconds(0), 3});
  const std::string text = long_text();
  std::thread writer([&] { write_all(client_, text); });
  EXPECT_EQ(read_n(server_, text.size()), text);
  writer.join();
}

TEST_F(ChaosProxyTest, HoldsWhatComesWhileItIsStalled) {
  Chaos stalled;
  stalled.stalled = true;
  proxy_.set(stalled);
  // Set before the bytes are there: nothing may pass from now on.
  write_all(client_, "held");
  std::this_thread::sleep_for(milliseconds(50));
  EXPECT_FALSE(is_readable(server_));
  proxy_.set({});
  EXPECT_EQ(read_n(server_, 4), "held");
}

TEST_F(ChaosProxyTest, ResetsBothEnds) {
  write_all(client_, "x");
  EXPECT_EQ(read_n(server_, 1), "x");
  proxy_.reset_connections();
  for (const int fd : {client_, server_}) {
    char byte = 0;
    EXPECT_EQ(recv(fd, &byte, 1, 0), -1);
    EXPECT_EQ(errno, ECONNRESET);
  }
}

TEST_F(ChaosProxyTest, TurnsOverOneBitOfWhatItReads) {
  Chaos corrupt;
  corrupt.corrupt_share = 1;
  proxy_.set(corrupt);
  const std::string text = "all of this is read at once";
  write_all(client_, text);
  const std::string got = read_n(server_, text.size());
  int bits = 0;
  for (std::size_t i = 0; i < text.size(); ++i) {
    bits += __builtin_popcount(static_cast<unsigned char>(text[i] ^ got[i]));
  }
  EXPECT_EQ(bits, 1);
}

TEST_F(ChaosProxyTest, EndsAConnectionWithItsClient) {
  shutdown(client_, SHUT_RDWR);
  EXPECT_EQ(read_n(server_, 1), "");
}

}  // namespace
}  // namespace graspd::trials
