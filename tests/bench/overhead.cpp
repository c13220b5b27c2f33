/// What the service costs a request: the round trip of a Kinect v2 frame (434 kB) through client
/// library, front and a worker process that answers at once, one in flight, with and without keys.
/// The two take turns, so that both see the same machine.
#include <fmt/format.h>
#include <sys/eventfd.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <fstream>
#include <future>
#include <nlohmann/json.hpp>
#include <thread>

#include "graspd/client/client.hpp"
#include "graspd/command_line/run_program.hpp"
#include "graspd/formats/table.hpp"
#include "graspd/service/front.hpp"
#include "graspd/service/private_directory.hpp"

namespace graspd::bench {
namespace {

constexpr std::chrono::seconds kBudget{20};
const ServerInfo kServer{"echo", "catalogue", "config"};

struct Options {
  std::filesystem::path out = "build/bench";
  int requests_n = 2000;
  int block_n = 100;
  service::WorkerOptions worker;
};

DepthFrame kinect_frame() {
  DepthFrame frame;
  frame.camera = {512, 424, 365, 365, 255.5, 211.5, {}};
  frame.depth.resize(512 * 424);
  for (std::size_t i = 0; i < frame.depth.size(); ++i) {
    frame.depth[i] = static_cast<std::uint16_t>(700 + i * 7919 % 97);
  }
  return frame;
}

/// A front with one worker process, and a client of it.
class Service {
 public:
  Service(std::string its_name, bool with_keys)
      : name(std::move(its_name)),
        stop_fd_(eventfd(0, EFD_CLOEXEC | EFD_SEMAPHORE)),
        launcher_("/proc/self/exe", {"bench_overhead", "worker"}),
        front_(options(with_keys), launcher_),
        thread_([this] { front_.run(); }) {
    ready_.get_future().wait();
    client::ClientOptions options;
    if (with_keys) options.keys = keys::ClientKeys{server_.public_key, cell_};
    client_ = std::make_unique<client::Client>(std::vector{front_.data_endpoint()}, options);
  }
  ~Service() {
    eventfd_write(stop_fd_, 2);
    thread_.join();
    close(stop_fd_);
  }
  Service(const Service&) = delete;
  Service& operator=(const Service&) = delete;

  void ask(const DepthFrame& frame, const PlanRequest& request) {
    const auto start = std::chrono::steady_clock::now();
    const auto answer = client_->plan(frame, request, kBudget);
    const std::chrono::duration<double, std::milli> time = std::chrono::steady_clock::now() - start;
    if (!answer) throw std::runtime_error(answer.error().message);
    times_ms.push_back(time.count());
  }

  std::string name;
  std::vector<double> times_ms;

 private:
  service::FrontOptions options(bool with_keys) {
    service::FrontOptions options;
    options.config.data_endpoint = "tcp://127.0.0.1:*";
    options.config.control_endpoint = "tcp://127.0.0.1:*";
    options.config.workers_n = 1;
    options.facts = {{"echo"}, kServer};
    options.worker_endpoint = "ipc://" + (directory_.path() / "workers").string();
    options.stop_fd = stop_fd_;
    options.on_ready = [this] { ready_.set_value(); };
    if (with_keys) {
      const auto list = directory_.path() / "allowed_cells";
      if (auto ok = keys::allow(list, {cell_.cell, cell_.public_key}); !ok) {
        throw std::runtime_error(ok.error().message);
      }
      options.authentication = service::Authentication{server_, *keys::AllowList::read(list)};
    }
    return options;
  }

  service::PrivateDirectory directory_;
  keys::KeyPair server_ = keys::make_key_pair("server");
  keys::KeyPair cell_ = keys::make_key_pair("default");
  int stop_fd_;
  std::promise<void> ready_;
  service::ProcessLauncher launcher_;
  service::Front front_;
  std::thread thread_;
  std::unique_ptr<client::Client> client_;
};

double quantile(std::vector<double> values, double share) {
  const auto at =
      values.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

void measure(const Options& options) {
  const DepthFrame frame = kinect_frame();
  PlanRequest request;
  request.parts = {{"echo", 0}};
  Service plain("plain", false);
  Service curve("curve", true);
  for (int i = 0; i < options.block_n; ++i) {
    plain.ask(frame, request);
    curve.ask(frame, request);
  }
  plain.times_ms.clear();
  curve.times_ms.clear();
  for (int done_n = 0; done_n < options.requests_n; done_n += options.block_n) {
    for (Service* service : {&plain, &curve}) {
      for (int i = 0; i < options.block_n; ++i) service->ask(frame, request);
    }
  }
  Table table({"service", "requests", "p10 ms", "p50 ms", "p99 ms"});
  nlohmann::json figures;
  for (const Service* service : {&plain, &curve}) {
    const auto& times_ms = service->times_ms;
    table.add({service->name, std::to_string(times_ms.size()),
               fmt::format("{:.2f}", quantile(times_ms, 0.1)),
               fmt::format("{:.2f}", quantile(times_ms, 0.5)),
               fmt::format("{:.2f}", quantile(times_ms, 0.99))});
    figures["overhead_" + service->name + "_p50_ms"] = quantile(times_ms, 0.5);
    figures["overhead_" + service->name + "_p10_ms"] = quantile(times_ms, 0.1);
  }
  fmt::print("{}", table.to_text());
  std::filesystem::create_directories(options.out);
  std::ofstream(options.out / "overhead.json") << figures.dump(2) << "\n";
  std::ofstream csv(options.out / "overhead.csv");
  csv << "service,ms\n";
  for (const Service* service : {&plain, &curve}) {
    for (const double ms : service->times_ms) csv << fmt::format("{},{:.4f}\n", service->name, ms);
  }
}

void work(service::WorkerOptions options) {
  service::prepare_worker_process(0);
  options.server = kServer;
  service::run_worker(options, [](const DepthFrame&, const PlanRequest&, auto) {
    return Result<PlanAnswer>(PlanAnswer());
  });
}

}  // namespace
}  // namespace graspd::bench

int main(int count, char** words) {
  return graspd::run_program("bench_overhead", count, words, [](CLI::App& app) {
    const auto options = std::make_shared<graspd::bench::Options>();
    app.description("Round trip of a depth frame through the service, with and without keys.");
    app.add_option("--out", options->out, "folder for overhead.json and overhead.csv");
    app.add_option("--requests", options->requests_n, "of each kind")->capture_default_str();
    CLI::App* worker = app.add_subcommand("worker", "");
    worker->group("");  // what the front starts
    worker->add_option("--endpoint", options->worker.endpoint);
    worker->add_option("--identity", options->worker.identity);
    app.callback([options, worker] {
      if (worker->parsed()) {
        graspd::bench::work(options->worker);
      } else {
        graspd::bench::measure(*options);
      }
    });
  });
}
