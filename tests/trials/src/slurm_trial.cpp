#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <thread>

#include "daemon.hpp"
#include "graspd/trials/fleet.hpp"
#include "namespaces.hpp"
#include "trial_servers.hpp"

namespace graspd::trials {
namespace {

using std::chrono::seconds;

constexpr int kNodes_n = 3;

std::string address_of(int node) { return fmt::format("10.77.0.1{}", node); }
std::string endpoint_of(int node) { return "tcp://" + address_of(node) + ":5555"; }

/// Runs `look` until it says true. \throws std::runtime_error, with `what`, after a minute.
template <class Look>
void wait_until(Look&& look, const std::string& what) {
  const TimePoint until = Clock::now() + seconds(60);
  while (!look()) {
    if (Clock::now() > until) throw std::runtime_error(what + ": not within a minute");
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
  }
}

/// A controller and nodes, each with its own network, name, mounts and processes.
class Cluster {
 public:
  Cluster(const std::filesystem::path& folder, const Keyring& keys) : folder_(folder) {
    write_configuration(keys);
    start_munge();
    controller_.run(
        "ip link add bridge type bridge && ip addr add 10.77.0.1/24 dev bridge && "
        "ip link set bridge up");
    daemons_.push_back(start(controller_, "controller", "slurmctld -D"));
    for (int node = 1; node <= kNodes_n; ++node) start_node(node);
    wait_until([&] { return slurm("sinfo --noheader --states=idle --format=%D") == "3\n"; },
               "three idle nodes");
  }

  /// Where the clients are.
  const NetworkNamespace& outside() const { return controller_; }
  /// A command of Slurm. \returns what it says
  std::string slurm(const std::string& command) const {
    return testing::run(
               fmt::format(
                   "cd {0} && SLURM_CONF={0}/slurm.conf PATH={0}:$PATH nsenter --net={1} {2}",
                   folder_.string(), controller_.path(), command))
        .output;
  }
  /// As if its power went.
  void lose(int node) { nodes_.at(static_cast<std::size_t>(node - 1))->kill(); }

 private:
  void write_configuration(const Keyring& keys) const {
    const auto write = [&](const std::string& name, const std::string& text) {
      std::ofstream(folder_ / name) << text;
    };
    write("cgroup.conf", "CgroupPlugin=cgroup/v1\n");
    write("slurm.conf",
          fmt::format("ClusterName=trial\nSlurmctldHost=controller(10.77.0.1)\nSlurmUser=root\n"
                      "AuthInfo=socket={0}/munge,cred_expire=10\nStateSaveLocation={0}/state\n"
                      "SlurmdSpoolDir={0}/spool-%n\nSlurmctldPidFile={0}/slurmctld.pid\n"
                      "SlurmdPidFile={0}/slurmd-%n.pid\nProctrackType=proctrack/linuxproc\n"
                      "TaskPlugin=task/none\nSelectType=select/cons_tres\n"
                      "SlurmdParameters=config_overrides\n"
                      // A small cluster may look more often for what can be started.
                      "SchedulerParameters=sched_interval=5,bf_interval=5\n"
                      "Include {1}/deploy/slurm/graspd.conf\n"
                      "NodeName=node[1-{2}] NodeAddr=10.77.0.1[1-{2}] CPUs=2\n"
                      "PartitionName=servers Nodes=ALL Default=YES MaxTime=INFINITE\n",
                      folder_.string(), GRASPD_SOURCE_DIR, kNodes_n));
    const std::vector<std::string> words = keys.server_words();
    write("server.yaml", fmt::format("data_endpoint: tcp://0.0.0.0:5555\ncontrol_endpoint: "
                                     "tcp://0.0.0.0:5556\nkey_file: {}\nallowed_cells: {}\n",
                                     words.at(1), words.at(3)));
    std::filesystem::create_directory(folder_ / "state");
    std::filesystem::create_symlink(GRASP_SERVER, folder_ / "grasp_server");
  }
  void start_munge() {
    daemons_.push_back(std::make_unique<Daemon>(
        fmt::format("umask 077 && head -c 128 /dev/urandom >{0}/munge.key && "
                    "exec munged -F --force --key-file={0}/munge.key --socket={0}/munge "
                    "--pid-file={0}/munge.pid --seed-file={0}/munge.seed --log-file={0}/munge.log",
                    folder_.string()),
        folder_ / "munged.log"));
    wait_until([&] { return std::filesystem::exists(folder_ / "munge"); }, "munged's socket");
  }
  void start_node(int node) {
    const NetworkNamespace& network = *networks_.emplace_back(std::make_unique<NetworkNamespace>());
    network.run(
        fmt::format("ip link add eth0 type veth peer name node{} netns {} && "
                    "ip addr add {}/24 dev eth0 && ip link set eth0 up",
                    node, controller_.path(), address_of(node)));
    controller_.run(
        fmt::format("ip link set node{0} master bridge && ip link set node{0} up", node));
    nodes_.push_back(start(network, fmt::format("node{}", node), "slurmd -D"));
  }
  std::unique_ptr<Daemon> start(const NetworkNamespace& network, const std::string& name,
                                const std::string& program) const {
    return std::make_unique<Daemon>(
        fmt::format(
            "exec nsenter --net={} unshare --mount-proc --uts --pid --fork --kill-child sh -c "
            "'hostname {} && SLURM_CONF={}/slurm.conf exec {}'",
            network.path(), name, folder_.string(), program),
        folder_ / (name + ".log"));
  }

  std::filesystem::path folder_;
  NetworkNamespace controller_;
  std::vector<std::unique_ptr<NetworkNamespace>> networks_;
  std::vector<std::unique_ptr<Daemon>> daemons_;
  std::vector<std::unique_ptr<Daemon>> nodes_;
};

}  // namespace

OnSlurm lose_a_slurm_node(std::size_t requests_n) {
  const testing::TemporaryFolder folder;
  const Keyring keys({"cell_0", "cell_1", "cell_2", "cell_3"});
  Cluster cluster(folder.path(), keys);
  const std::string job = cluster.slurm(fmt::format(
      "sbatch --array=0-1 {}/deploy/slurm/graspd.sbatch server.yaml", GRASPD_SOURCE_DIR));
  OnSlurm seen;
  History history;
  cluster.outside().in([&] {
    client::ClientOptions probe;
    probe.cell = "cell_0";
    probe.keys = keys.of_cells().at("cell_0");
    const auto serves = [&](int node) {
      client::Client client({endpoint_of(node)}, probe);
      return client.health(seconds(1)).at(0).health.has_value();
    };
    for (const int node : {1, 2}) {
      wait_until([&] { return serves(node); }, fmt::format("a server on node {} ({})", node, job));
    }
    LoadOptions options = cells_of({endpoint_of(1), endpoint_of(2), endpoint_of(3)}, 4);
    options.keys = keys.of_cells();
    options.dispatch.attempt_timeout = std::chrono::milliseconds(500);
    ClosedLoop load(options, history);
    history.wait_for(requests_n);
    const TimePoint lost = Clock::now();
    cluster.lose(1);
    wait_until([&] { return serves(3); }, "the lost server on node 3");
    seen.lost_until_back_s = std::chrono::duration<double>(Clock::now() - lost).count();
    history.wait_for(requests_n);
    load.stop();
  });
  static_cast<Seen&>(seen) = seen_in(history);
  return seen;
}

std::string why_no_slurm() {
  if (testing::run("command -v munged slurmctld slurmd sbatch sinfo").exit_code != 0) {
    return "Slurm or munge is not installed: deploy/install-deps --deploy";
  }
  return why_no_namespaces();
}

}  // namespace graspd::trials
