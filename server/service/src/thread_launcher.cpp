#include <sys/eventfd.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <system_error>
#include <thread>
#include <zmq.hpp>

#include "graspd/service/launcher.hpp"
#include "worker_loop.hpp"

namespace graspd::service {
namespace {

class WorkerThread : public WorkerHandle {
 public:
  WorkerThread(const PlanHandler& handler, WorkerOptions options)
      : ended_fd_(eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK)) {
    if (ended_fd_ < 0) throw std::system_error(errno, std::generic_category(), "eventfd");
    thread_ = std::thread([this, handler, options = std::move(options)] {
      try {
        run_worker(context_, options, handler);
        reason_ = "ended when told to";
      } catch (const std::exception& error) {
        reason_ = error.what();
      }
      ended_.store(true, std::memory_order_release);
      eventfd_write(ended_fd_, 1);
    });
  }
  WorkerThread(const WorkerThread&) = delete;
  WorkerThread& operator=(const WorkerThread&) = delete;
  ~WorkerThread() override {
    context_.shutdown();
    thread_.join();
    close(ended_fd_);
  }

  int exit_fd() const override { return ended_fd_; }
  std::optional<std::string> exit_reason() override {
    if (!ended_.load(std::memory_order_acquire)) return std::nullopt;
    return reason_;
  }
  void kill() override { context_.shutdown(); }
  std::string name() const override { return "a thread"; }

 private:
  zmq::context_t context_;
  int ended_fd_;
  std::atomic<bool> ended_ = false;
  std::string reason_;  ///< written by the thread before `ended_`
  std::thread thread_;
};

}  // namespace

std::unique_ptr<WorkerHandle> ThreadLauncher::launch(const std::string& endpoint,
                                                     const std::string& identity) {
  return std::make_unique<WorkerThread>(handler_,
                                        WorkerOptions{endpoint, identity, server_, golden_});
}

}  // namespace graspd::service
