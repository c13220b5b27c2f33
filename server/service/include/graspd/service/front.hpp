#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "graspd/keys/allow_list.hpp"
#include "graspd/keys/key_files.hpp"
#include "graspd/service/config.hpp"
#include "graspd/service/launcher.hpp"
#include "graspd/service/log.hpp"
#include "graspd/types/answer.hpp"

/// Problem: many cells share a few workers, and no cell, client or frame may take the service away
/// from the others.
///
/// Design: one thread owns every socket. It reads what has come in before it does anything else,
/// looks at envelopes only, and never waits: not for a client, not for a worker. What it can't do
/// now it queues for a short time or refuses with a reason. Computing happens in workers, which are
/// other processes, so that a frame that crashes one costs one request.
///
///     clients ── data ROUTER ──▶ take_in ─▶ Admission ─▶ Supervisor ── workers ROUTER ──▶ workers
///     probes ─── control ROUTER ─▶ health
///     Prometheus, probes ── HTTP, on threads of its own ─▶ Metrics, Status
///
/// Guarantees: every request that can be answered gets exactly one answer; health is answered
/// within the time of one turn of the loop, whatever the load; when told to drain, everything
/// accepted is still finished; when told to reload, too, and workers with the new parts take over
/// once all of them are ready. With keys nothing is decoded but what came from an allowed one; that
/// this is so is tried out before anything is read.
namespace graspd::service {

/// What the front says of the server it stands for.
struct ServerFacts {
  std::vector<std::string> part_ids;
  ServerInfo server;
};

/// Who may come in.
struct Authentication {
  keys::KeyPair server;
  keys::AllowList allowed;
};

/// What a reload brings: a catalogue, and what launches workers that have it.
struct NewParts {
  ServerFacts facts;
  std::unique_ptr<WorkerLauncher> launcher;
};

/// What the server is at, for whoever started it.
enum class Phase {
  kStarting,
  kReady,
  kReloading,  ///< and serving
  kDraining,
};

/// What a front needs from whoever starts it.
struct FrontOptions {
  ServerConfig config;
  ServerFacts facts;
  std::optional<Authentication> authentication;  ///< without it everybody may come in
  std::string worker_endpoint;  ///< ipc://…, in a folder that nobody else may enter
  /// A descriptor (signalfd, eventfd) that becomes readable when the server is to drain, and again
  /// when it is to stop at once.
  int stop_fd = -1;
  /// Becomes readable when the list of allowed cells and the parts are to be read anew.
  int reload_fd = -1;
  /// Called on a thread of its own. Where it fails, the parts in force stay.
  std::function<Result<NewParts>()> load_parts;
  Log log;
  std::function<void()> on_ready;      ///< once, when every worker is ready
  std::function<void(Phase)> on_turn;  ///< on every turn of the loop, at least once a second
};

/// An endpoint is in use, or is not this machine's.
class CannotListen : public std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// The server's sockets and its loop.
class Front {
 public:
  /// Binds all sockets; `launcher` must outlive the front.
  /// \throws CannotListen
  Front(FrontOptions options, WorkerLauncher& launcher);
  ~Front();
  Front(const Front&) = delete;
  Front& operator=(const Front&) = delete;

  /// As it was bound: with the port that the system gave.
  std::string data_endpoint() const;
  std::string control_endpoint() const;
  /// http://HOST:PORT; empty where there is no HTTP.
  std::string http_url() const;
  /// Serves until told to stop and drained.
  /// \throws std::exception where it can't go on: workers that never get ready, no memory,
  /// authentication that lets in whom it should not.
  void run();

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace graspd::service
