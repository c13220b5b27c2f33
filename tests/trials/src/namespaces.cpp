#include "namespaces.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sched.h>
#include <unistd.h>

#include <cerrno>
#include <future>
#include <stdexcept>
#include <system_error>

#include "graspd/trials/trials.hpp"
#include "serve_process.hpp"

namespace graspd::trials {

NetworkNamespace::NetworkNamespace() {
  // A namespace is of a thread: one is made for it, and ends.
  std::async(std::launch::async, [this] {
    if (unshare(CLONE_NEWNET) != 0) {
      throw std::system_error(errno, std::generic_category(), "a network namespace");
    }
    fd_ = open("/proc/thread-self/ns/net", O_RDONLY | O_CLOEXEC);
    if (fd_ < 0)
      throw std::system_error(errno, std::generic_category(), "/proc/thread-self/ns/net");
  }).get();
  run("ip link set lo up");
}

NetworkNamespace::~NetworkNamespace() { close(fd_); }

void NetworkNamespace::in(const std::function<void()>& work) const {
  std::async(std::launch::async, [&] {
    if (setns(fd_, CLONE_NEWNET) != 0) {
      throw std::system_error(errno, std::generic_category(), "setns");
    }
    work();
  }).get();
}

void NetworkNamespace::run(const std::string& command) const {
  in([&] {
    const testing::Finished finished = testing::run(command);
    if (finished.exit_code != 0) {
      throw std::runtime_error(fmt::format("{}: {}", command, finished.output));
    }
  });
}

std::string NetworkNamespace::path() const { return fmt::format("/proc/{}/fd/{}", getpid(), fd_); }

std::string why_no_namespaces() {
  try {
    const NetworkNamespace network;
    network.run("tc qdisc add dev lo root tbf rate 20mbit burst 64kb latency 400ms");
    network.run(
        "nft 'add table inet t; add chain inet t c { type filter hook input priority 0; }; "
        "add rule inet t c numgen random mod 100 < 5 accept'");
    return {};
  } catch (const std::exception& error) {
    return fmt::format(
        "network namespaces with loss and bandwidth need root, iproute2 and nftables: {}",
        error.what());
  }
}

}  // namespace graspd::trials
