#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "graspd/service/worker.hpp"

namespace graspd::service {

/// One running worker. Destroying it ends it.
class WorkerHandle {
 public:
  virtual ~WorkerHandle() = default;
  /// A descriptor that becomes readable when the worker has ended.
  virtual int exit_fd() const = 0;
  /// Why it ended, as "killed by signal 9 (Killed)"; nothing while it lives.
  virtual std::optional<std::string> exit_reason() = 0;
  /// Ends it now, whatever it is doing. It has ended when `exit_fd` says so.
  virtual void kill() = 0;
  /// 0 where it is no process of its own.
  virtual int pid() const { return 0; }
  /// For logs: "pid 4711".
  virtual std::string name() const = 0;
};

/// How workers come into being. A launched worker connects to `endpoint` as `identity`.
class WorkerLauncher {
 public:
  virtual ~WorkerLauncher() = default;
  /// Returns at once. \throws std::system_error where the system starts no more.
  virtual std::unique_ptr<WorkerHandle> launch(const std::string& endpoint,
                                               const std::string& identity) = 0;
};

/// Starts `program`, with `words… --endpoint E --identity I` as its arguments, as a process that
/// dies with the thread that launched it. The first word is the program's name, as always. Fork and
/// exec at once: a process forked from one with threads may do little else.
class ProcessLauncher : public WorkerLauncher {
 public:
  ProcessLauncher(std::string program, std::vector<std::string> words)
      : program_(std::move(program)), words_(std::move(words)) {}
  std::unique_ptr<WorkerHandle> launch(const std::string& endpoint,
                                       const std::string& identity) override;

 private:
  std::string program_;
  std::vector<std::string> words_;
};

/// Runs workers as threads of this process (`workers_n: 0`), where a debugger sees everything. They
/// can't be killed: one that hangs, hangs; one that crashes takes the server with it.
class ThreadLauncher : public WorkerLauncher {
 public:
  ThreadLauncher(PlanHandler handler, ServerInfo server,
                 std::shared_ptr<const GoldenFrame> golden = nullptr)
      : handler_(std::move(handler)), server_(std::move(server)), golden_(std::move(golden)) {}
  std::unique_ptr<WorkerHandle> launch(const std::string& endpoint,
                                       const std::string& identity) override;

 private:
  PlanHandler handler_;
  ServerInfo server_;
  std::shared_ptr<const GoldenFrame> golden_;
};

}  // namespace graspd::service
