#pragma once

#include <cstddef>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>
#include <zmq.hpp>

#include "graspd/keys/allow_list.hpp"
#include "graspd/keys/key_files.hpp"

namespace graspd::service {

/// Says who may come in, when libzmq asks (ZAP, RFC 27), on a thread of its own named "zap", so
/// that a handshake never waits for the front.
///
/// CURVE alone lets every key in where nobody answers ZAP. Sockets that are protected here refuse
/// everybody then; and since what libzmq does is what counts, `test` tries it out.
///
/// All but the thread itself belongs to the front's thread.
class Authenticator {
 public:
  /// Listens at once: construct it before the first socket that it protects. One in a context.
  Authenticator(zmq::context_t& context, keys::KeyPair server, keys::AllowList allowed);
  ~Authenticator();
  Authenticator(const Authenticator&) = delete;
  Authenticator& operator=(const Authenticator&) = delete;

  /// To be called before the socket is bound.
  void protect(zmq::socket_t& socket) const;
  /// Connects to a protected endpoint with a key that nobody knows, and with one that only this
  /// object knows. \returns INTERNAL unless the first is refused and the second let in.
  Result<void> test(const std::string& endpoint) const;

  void replace(keys::AllowList allowed);
  /// The cell whose key this frame came under; nothing where that key has been taken out of the
  /// list since. \param envelope not the routing id, which has no User-Id after a poll
  std::optional<std::string> cell_of(const zmq::message_t& envelope) const;

  /// Whether the thread has answered what it was asked at the last few calls. Asks it again.
  bool alive();
  struct News {
    std::vector<std::string> notices;  ///< for the log
    std::size_t refused_n = 0;         ///< connections
  };
  /// What happened at the door since the last call.
  News news();

 private:
  using Lists = std::shared_ptr<const keys::AllowList>;
  Lists allowed() const;
  void run();
  void answer_one();
  std::optional<std::string> user_of(const std::string& key) const;
  void note_refusal(const std::string& address);

  keys::KeyPair server_;
  keys::KeyPair probe_;     ///< let in; never leaves this process
  keys::KeyPair stranger_;  ///< refused, without a word in the log
  mutable std::mutex mutex_;
  Lists allowed_;          ///< guarded by mutex_
  News news_;              ///< guarded by mutex_
  zmq::socket_t handler_;  ///< the thread's, while it runs
  zmq::socket_t pulse_;
  bool asking_ = false;
  int missed_n_ = 0;
  int stop_fd_;
  std::thread thread_;
};

}  // namespace graspd::service
