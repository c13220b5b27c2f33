#include <fmt/format.h>
#include <sys/signalfd.h>

#include <chrono>
#include <csignal>
#include <initializer_list>
#include <string>

#include "graspd/service/front.hpp"
#include "graspd/service/private_directory.hpp"
#include "service_script.hpp"

/// `grasp_server` but for the planning: the real front and real worker processes, which do what a
/// request's part says (service_script.hpp). Understands as much of grasp_server's command line as
/// the trials need; of an option that is given twice the last one counts.
namespace graspd::service {
namespace {

class Words {
 public:
  Words(int count, char** words) : words_(words + 1, words + count) {}
  bool has(const std::string& word) const {
    return std::find(words_.begin(), words_.end(), word) != words_.end();
  }
  std::string option(const std::string& name, const std::string& otherwise) const {
    std::string value = otherwise;
    for (std::size_t i = 0; i + 1 < words_.size(); ++i) {
      if (words_[i] == name) value = words_[i + 1];
    }
    return value;
  }

 private:
  std::vector<std::string> words_;
};

int signal_descriptor(std::initializer_list<int> numbers) {
  sigset_t signals;
  sigemptyset(&signals);
  for (const int number : numbers) sigaddset(&signals, number);
  pthread_sigmask(SIG_BLOCK, &signals, nullptr);
  return signalfd(-1, &signals, SFD_CLOEXEC);
}

int serve(const Words& words) {
  const PrivateDirectory folder;
  ProcessLauncher launcher("/proc/self/exe", {"scripted_server", "worker"});
  FrontOptions options;
  ServerConfig& config = options.config;
  config.data_endpoint = config.control_endpoint = "tcp://127.0.0.1:0";
  const std::string file = words.option("--config", "");
  if (!file.empty()) config = read_config(file).value();
  config.data_endpoint = words.option("--endpoint", config.data_endpoint);
  config.control_endpoint = words.option("--control-endpoint", config.control_endpoint);
  config.workers_n = static_cast<std::uint32_t>(std::stoul(words.option("--workers", "2")));
  config.insecure = words.has("--insecure");
  if (!config.insecure) {
    config.allowed_cells = words.option("--allowed-cells", config.allowed_cells);
    options.authentication = {keys::read_key_pair(words.option("--key", config.key_file)).value(),
                              keys::AllowList::read(config.allowed_cells).value()};
  }
  options.facts.part_ids = kScriptedParts;
  options.facts.server = kScriptedServer;
  options.worker_endpoint = "ipc://" + (folder.path() / "workers").string();
  options.stop_fd = signal_descriptor({SIGTERM, SIGINT});
  options.reload_fd = signal_descriptor({SIGHUP});
  options.log = [least = words.option("--log-level", "warning")](LogLevel level,
                                                                 std::string_view line) {
    if (level < parse_enum<LogLevel>(least).value()) return;
    const std::chrono::duration<double, std::milli> now =
        std::chrono::steady_clock::now().time_since_epoch();
    fmt::print(stderr, "{{\"at_ms\":{:.3f},{}\n", now.count(), line.substr(1));
  };
  const Front* running = nullptr;
  options.on_ready = [&] {
    fmt::print("grasp_server ready: data {}, control {}, scripted\n", running->data_endpoint(),
               running->control_endpoint());
    std::fflush(stdout);
  };
  Front front(options, launcher);
  running = &front;
  front.run();
  return 0;
}

int work(const Words& words) {
  WorkerOptions options;
  options.endpoint = words.option("--endpoint", "");
  options.identity = words.option("--identity", "");
  options.server = kScriptedServer;
  prepare_worker_process(512);
  run_worker(options, scripted_plan);
  return 0;
}

}  // namespace
}  // namespace graspd::service

int main(int count, char** words) {
  using namespace graspd::service;
  try {
    const Words given(count, words);
    return given.has("worker") ? work(given) : serve(given);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "scripted_server: %s\n", error.what());
    return 1;
  }
}
