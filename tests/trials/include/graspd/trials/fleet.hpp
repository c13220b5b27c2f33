#pragma once

#include "graspd/trials/trials.hpp"

/// Servers on several machines, run by what deploy/ brings: its files as they are, HAProxy and
/// Slurm as Debian has them, each machine a namespace of this one.
namespace graspd::trials {

struct BehindHaproxy : Seen {
  std::vector<int> answers_n;  ///< of each server, before one of them is killed
};
/// 8 cells that know the address of deploy/haproxy/haproxy.cfg alone; one of its two servers is
/// killed, and started again. \param requests_n of each phase
BehindHaproxy kill_one_server_behind_haproxy(std::size_t requests_n);
/// Empty where that can be run here; otherwise a sentence.
std::string why_no_haproxy();

struct OnSlurm : Seen {
  double lost_until_back_s = 0;  ///< from the node's end until another one has its server
};
/// deploy/slurm/graspd.sbatch on a cluster of three nodes, two servers; the first one's node is
/// lost. \param requests_n before that, and after the server is back
OnSlurm lose_a_slurm_node(std::size_t requests_n);
std::string why_no_slurm();

}  // namespace graspd::trials
