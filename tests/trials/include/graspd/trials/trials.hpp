#pragma once

#include <cstddef>
#include <string>
#include <vector>

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

struct Overload : Seen {
  double peak_hz = 0;     ///< of plans, with as many in flight as keeps every worker busy
  double goodput_hz = 0;  ///< of plans, at twice the peak
  double goodput_share = 0;
  int silent_n = 0;  ///< requests that the server never answered
};
Overload overload(int requests_n);

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
/// One fault after another, now on one server's network, now on the other's: delay, chopping, a stall
/// that ends (and lets late answers through), resets.
Seen faults_in_turn(std::size_t requests_n, int faults_n);
struct CorruptedNeighbour : Seen {  ///< of the clients with a good network
  Seen corrupted;  ///< its violations count nothing: without keys TCP's checksum is all there is
  int workers_lost_n = 0;
};
/// One bit in a tenth of what one cell sends is turned over, beside cells with a good network.
CorruptedNeighbour beside_a_corrupt_network(std::size_t requests_n);

/// Health of a server whose workers are all busy, in milliseconds of a round trip, sorted.
std::vector<double> health_ms_while_busy(int probes_n);

/// Plans per second of `workers_n` workers that each need a core.
double plans_hz(int workers_n, std::size_t requests_n);
/// CPU time of the front's process for one request of 434 KB, in milliseconds.
double front_cpu_ms(std::size_t requests_n);

}  // namespace graspd::trials
