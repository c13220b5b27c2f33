#include <fmt/format.h>

#include <span>

#include "namespaces.hpp"
#include "trial_servers.hpp"

namespace graspd::trials {
namespace {

/// A server on a machine of its own, and the cable to it.
class Machine {
 public:
  Machine(int number, const NetworkNamespace& clients, const Keyring& keys)
      : client_end_(fmt::format("server{}", number)), clients_(clients) {
    own_.run(fmt::format("ip link add eth0 type veth peer name {} netns {}", client_end_,
                         clients.path()));
    own_.run(fmt::format("ip addr add 10.77.{}.2/24 dev eth0 && ip link set eth0 up", number));
    clients.run(fmt::format("ip addr add 10.77.{0}.1/24 dev {1} && ip link set {1} up", number,
                            client_end_));
    own_.in([&] { server_ = start_server(2, fmt::format("tcp://10.77.{}.2:0", number), &keys); });
  }
  const std::string& endpoint() const { return server_->data_endpoint; }

  /// \param percent of the packets, each way; 100 is a partition
  void lose(int percent) const {
    own_.run(fmt::format(
        "nft 'table inet lossy {{ "
        "chain in {{ type filter hook input priority 0; numgen random mod 100 <= {0} drop; }}; "
        "chain out {{ type filter hook output priority 0; numgen random mod 100 <= {0} drop; }}; "
        "}}'",
        percent - 1));
  }
  void lose_nothing() const { own_.run("nft flush ruleset"); }
  void limit_to_20_mbit() const {
    const std::string limit = "tc qdisc add dev {} root tbf rate 20mbit burst 64kb latency 400ms";
    own_.run(fmt::format(fmt::runtime(limit), "eth0"));
    clients_.run(fmt::format(fmt::runtime(limit), client_end_));
  }

 private:
  std::string client_end_;
  const NetworkNamespace& clients_;
  NetworkNamespace own_;
  std::unique_ptr<testing::ServeProcess> server_;
};

void apply(LinkFault fault, const Machine& machine) {
  switch (fault) {
    case LinkFault::kPartition:
      return machine.lose(100);
    case LinkFault::kLoss5:
      return machine.lose(5);
    case LinkFault::kLoss30:
      return machine.lose(30);
    case LinkFault::k20Mbit:
      return machine.limit_to_20_mbit();
  }
}

/// \param bad_n of the two links
Seen with_bad_links(LinkFault fault, std::size_t bad_n, std::chrono::milliseconds length,
                    const client::DispatchOptions& dispatch) {
  const NetworkNamespace clients;
  const Keyring keys({"cell_0", "cell_1", "cell_2", "cell_3"});
  const Machine machines[]{{1, clients, keys}, {2, clients, keys}};
  const std::span bad(machines, bad_n);
  History history;
  clients.in([&] {
    LoadOptions options = cells_of({machines[0].endpoint(), machines[1].endpoint()}, 4);
    options.keys = keys.of_cells();
    options.dispatch = dispatch;
    ClosedLoop load(options, history);
    history.wait_for(50);
    for (const Machine& machine : bad) apply(fault, machine);
    const TimePoint until = Clock::now() + length;
    while (Clock::now() < until) history.wait_for(1);
    for (const Machine& machine : bad) {
      if (fault != LinkFault::k20Mbit) machine.lose_nothing();
    }
    history.wait_for(50);
    load.stop();
  });
  return seen_in(history);
}

}  // namespace

Seen one_of_two_links_is_bad(LinkFault fault, std::chrono::milliseconds length) {
  client::DispatchOptions dispatch;
  dispatch.attempt_timeout = kLinkAttempt;
  return with_bad_links(fault, 1, length, dispatch);
}

Seen both_links_are_bad(LinkFault fault, std::chrono::milliseconds length) {
  return with_bad_links(fault, 2, length, {});
}

}  // namespace graspd::trials
