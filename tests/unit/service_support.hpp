#pragma once

#include <sys/eventfd.h>
#include <unistd.h>

#include <algorithm>
#include <condition_variable>
#include <functional>
#include <future>
#include <mutex>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

#include "graspd/service/fair_queue.hpp"
#include "graspd/service/front.hpp"
#include "graspd/service/private_directory.hpp"
#include "service_script.hpp"

/// A real front with real sockets in this process, with scripted planners behind it.
namespace graspd::service {

/// A planner that waits until it is let go on: what is computing, and when it ends, is the test's.
class Gate {
 public:
  PlanHandler handler() {
    return [this](const DepthFrame& frame, const PlanRequest& request, TimePoint deadline) {
      std::unique_lock lock(mutex_);
      ++entered_n_;
      changed_.notify_all();
      changed_.wait(lock, [this] { return open_; });
      lock.unlock();
      return scripted_plan(frame, request, deadline);
    };
  }
  void open() {
    const std::lock_guard lock(mutex_);
    open_ = true;
    changed_.notify_all();
  }
  void close() {
    const std::lock_guard lock(mutex_);
    open_ = false;
  }
  int entered_n() {
    const std::lock_guard lock(mutex_);
    return entered_n_;
  }
  void wait_for_entered(int count) {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [&] { return entered_n_ >= count; });
  }

 private:
  std::mutex mutex_;
  std::condition_variable changed_;
  bool open_ = false;
  int entered_n_ = 0;
};

inline ServerConfig scripted_config(std::uint32_t workers_n) {
  ServerConfig config;
  config.data_endpoint = "tcp://127.0.0.1:*";
  config.control_endpoint = "tcp://127.0.0.1:*";
  config.workers_n = workers_n;
  config.insecure = true;
  return config;
}

class RunningFront {
 public:
  /// \param change what else the front is told
  RunningFront(const ServerConfig& config, WorkerLauncher& launcher,
               const std::function<void(FrontOptions&)>& change = {})
      : stop_fd_(eventfd(0, EFD_CLOEXEC | EFD_SEMAPHORE)),
        reload_fd_(eventfd(0, EFD_CLOEXEC)),
        front_(options(config, change), launcher) {
    data_endpoint = front_.data_endpoint();
    control_endpoint = front_.control_endpoint();
    http_url = front_.http_url();
    thread_ = std::thread([this] {
      try {
        front_.run();
        ended_.set_value("");
      } catch (const std::exception& error) {
        ended_.set_value(error.what());
      }
    });
  }
  ~RunningFront() {
    // Twice: at once, whatever is still running.
    stop();
    if (end_.wait_for(std::chrono::milliseconds(0)) != std::future_status::ready) stop();
    thread_.join();
    close(stop_fd_);
    close(reload_fd_);
  }
  RunningFront(const RunningFront&) = delete;
  RunningFront& operator=(const RunningFront&) = delete;

  void wait_ready() { ready_.get_future().wait(); }
  void stop() { eventfd_write(stop_fd_, 1); }
  void reload() { eventfd_write(reload_fd_, 1); }
  /// Waits for the end of `run`. \returns its exception's text, or nothing.
  std::string wait_end() { return end_.get(); }
  std::vector<std::string> log() {
    const std::lock_guard lock(log_mutex_);
    return log_;
  }
  /// Until a line of the log has this in it.
  void wait_for_log(std::string_view text) {
    std::unique_lock lock(log_mutex_);
    logged_.wait(lock, [&] {
      return std::any_of(log_.begin(), log_.end(), [&](const std::string& line) {
        return line.find(text) != std::string::npos;
      });
    });
  }

  std::string data_endpoint;
  std::string control_endpoint;
  std::string http_url;

 private:
  FrontOptions options(const ServerConfig& config,
                       const std::function<void(FrontOptions&)>& change) {
    FrontOptions options;
    options.config = config;
    options.facts = {kScriptedParts, kScriptedServer};
    options.worker_endpoint = "ipc://" + (directory_.path() / "workers").string();
    options.stop_fd = stop_fd_;
    options.reload_fd = reload_fd_;
    options.on_ready = [this] { ready_.set_value(); };
    options.log = [this](LogLevel, std::string_view line) {
      const std::lock_guard lock(log_mutex_);
      log_.emplace_back(line);
      logged_.notify_all();
    };
    if (change) change(options);
    return options;
  }

  PrivateDirectory directory_;
  int stop_fd_;
  int reload_fd_;
  std::promise<void> ready_;
  std::promise<std::string> ended_;
  std::shared_future<std::string> end_ = ended_.get_future().share();
  std::mutex log_mutex_;
  std::condition_variable logged_;
  std::vector<std::string> log_;
  Front front_;
  std::thread thread_;
};

}  // namespace graspd::service
