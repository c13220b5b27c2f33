#pragma once

#include <chrono>
#include <cstddef>
#include <string>
#include <vector>

#include "graspd/types/enum_names.hpp"

/// What is done to a service under load, and what its clients see of it: the rows of SERVICE.md's
/// table, each as a function that tests call for seconds and the bench for minutes. The servers are
/// real processes with the real front, in front of workers that take a known time.
namespace graspd::trials {

/// What all trials tell.
struct Seen {
  int asked_n = 0;
  int failed_n = 0;   ///< ended without an answer that is OK
  std::string ended;  ///< how many with which code, as "OK 398, BUSY 2"
  double p50_ms = 0;
  double p99_ms = 0;
  double worst_ms = 0;
  std::vector<std::string> violations;  ///< History's
};

/// Each server computes two requests at a time in 20 ms, 8 cells ask. \param requests_n of each of
/// the phases that the disturbance separates
Seen kill_one_of_two_servers(std::size_t requests_n);
/// \param workers_lost_n how many workers are killed, one after another
Seen kill_workers(std::size_t requests_n, int workers_lost_n);

struct RollingRestart : Seen {
  std::vector<int> exit_codes;
  double longest_stop_s = 0;
};
/// Each of two servers is told to stop, and started again on its port.
RollingRestart rolling_restart(std::size_t requests_n);

struct OpenLoop : Seen {
  double peak_hz = 0;        ///< of plans, with as many in flight as keeps every worker busy
  double goodput_hz = 0;     ///< of plans, at the rate asked for
  double goodput_share = 0;  ///< of the peak
  int silent_n = 0;          ///< requests that the server never answered
};
/// Requests come at planned instants, whatever becomes of those before. \param capacity_share how
/// many, as a share of the peak
OpenLoop open_loop(double capacity_share, int requests_n);

struct QuietCell : Seen {  ///< of the quiet cell
  Seen noisy;
};
/// One worker, 20 ms; a cell with 4 × 40 requests in flight beside one that asks seven times a
/// second.
QuietCell quiet_cell(int requests_n);

/// 5 ms each way, and never more than 1000 bytes at once.
Seen through_a_slow_network(std::size_t requests_n);
/// Nothing passes to or from one of two servers any more, and no connection ends.
Seen one_of_two_networks_stalls(std::size_t requests_n);
/// Every connection to one of two servers is reset, again and again.
Seen connections_reset(std::size_t requests_n, int resets_n);
/// One fault after another, now on one server's network, now on the other's: delay, chopping, a
/// stall that ends (and lets late answers through), resets.
Seen faults_in_turn(std::size_t requests_n, int faults_n);
struct CorruptedNeighbour : Seen {  ///< of the clients with a good network
  Seen corrupted;  ///< its violations count nothing: without keys TCP's checksum is all there is
  int workers_lost_n = 0;
};
/// One bit in a tenth of what one cell sends is turned over, beside cells with a good network.
CorruptedNeighbour beside_a_corrupt_network(std::size_t requests_n);

struct RevokedKey : Seen {       ///< of the cells that stay allowed
  int ok_before_n = 0;           ///< of the other one
  std::string refusal;           ///< code and sentence, on the connection it has
  std::string newcomer_refusal;  ///< and on a new one
  int ok_after_n = 0;
};
/// Under CURVE, one cell is taken from the list and the server told to read it again, while others
/// ask on.
RevokedKey revoke_a_key(std::size_t requests_n);

/// Two servers and their cells change to another server key, as deploy/README.md says: one server,
/// then cell by cell, then the other server. \param requests_n of each step
Seen change_the_server_key(std::size_t requests_n);

struct Crowd : Seen {
  double alone_p99_ms = 0;      ///< of the same client before
  std::size_t connected_n = 0;  ///< of the crowd at once, at most
};
enum class CrowdKind {
  kSilent,   ///< connects and says nothing
  kStalled,  ///< stops in the middle of a message
};
/// One good client beside `peers_n` others, which come back when they are thrown out.
Crowd beside_a_crowd(CrowdKind kind, int peers_n, std::size_t requests_n);

enum class LinkFault { kPartition, kLoss5, kLoss30, k20Mbit };
/// The clients' `attempt_timeout` there.
inline constexpr std::chrono::milliseconds kLinkAttempt{500};
/// Two servers and their clients in network namespaces, with keys; the link to one server is bad
/// for `length` (of 20 Mb/s, to the end). Needs what `why_no_namespaces` says.
Seen one_of_two_links_is_bad(LinkFault fault, std::chrono::milliseconds length);
/// The same fault on both, with the clients' usual `attempt_timeout`: requests may fail, by a named
/// error and within their budget.
Seen both_links_are_bad(LinkFault fault, std::chrono::milliseconds length);
/// Empty where network namespaces can be made here; otherwise a sentence.
std::string why_no_namespaces();

struct OncePerId : Seen {
  int computed_n = 0;
  int again_n = 0;    ///< of an id that had been computed and answered: the answer was lost
  int at_once_n = 0;  ///< of an id that was being computed: never
};
/// How often a server computes what is asked again because a connection was lost.
OncePerId computations_per_id(int resets_n);

struct Soak : Seen {
  int faults_n = 0;
  std::vector<double> memory_mb;  ///< of both servers with their workers, after each fault
};
/// Two servers with keys at 70 % of what one of them can do, one fault after another: delay, stall,
/// chopping, reset connections, a reload. Returns when the servers have as few descriptors as
/// before.
Soak soak(std::chrono::milliseconds length, std::chrono::milliseconds fault_every);

struct Overhead {
  double plain_p50_ms = 0;
  double curve_p50_ms = 0;
};
/// The round trip of 434 KB through client, front and a worker that answers at once, one in flight,
/// without and with keys. The two take turns, so that both see the same machine.
Overhead overhead(int requests_n);

/// Health of a server whose workers are all busy, in milliseconds of a round trip, sorted.
std::vector<double> health_ms_while_busy(int probes_n);

/// Plans per second of `workers_n` workers that each need a core.
double plans_hz(int workers_n, std::size_t requests_n);
/// CPU time of the front's process for one request of 434 KB, in milliseconds.
double front_cpu_ms(std::size_t requests_n);

}  // namespace graspd::trials

namespace graspd {

template <>
struct EnumNames<trials::LinkFault> {
  static constexpr std::pair<trials::LinkFault, std::string_view> values[]{
      {trials::LinkFault::kPartition, "partition"},
      {trials::LinkFault::kLoss5, "loss_5"},
      {trials::LinkFault::kLoss30, "loss_30"},
      {trials::LinkFault::k20Mbit, "slow_20_mbit"}};
};

}  // namespace graspd
