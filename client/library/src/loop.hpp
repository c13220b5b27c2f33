#pragma once

#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>
#include <zmq.hpp>

#include "graspd/client/client.hpp"
#include "resolver.hpp"
#include "server_link.hpp"

namespace graspd::client {

/// The thread that owns the sockets. Other threads hand it calls through a queue and an eventfd.
class Client::Loop {
 public:
  using Done = std::function<void(Result<Answer>, std::optional<TimePoint> sent)>;

  struct Call {
    Request request;       ///< attempt and budget are filled in with each attempt
    std::string envelope;  ///< not empty: this is sent, with the header of `request`
    std::shared_ptr<const std::vector<std::byte>> payload;  ///< null for health
    TimePoint deadline;
    std::string only;               ///< not empty: ask this server, once
    Done done;                      ///< called once, on the loop's thread
    std::optional<TimePoint> sent;  ///< its first attempt
  };

  Loop(const std::vector<std::string>& endpoints, std::optional<keys::ClientKeys> keys,
       const DispatchOptions& options, const NameOptions& names);
  ~Loop();
  void post(Call call);
  /// Once every name has been looked up, or at the deadline.
  Directory servers(TimePoint deadline) const { return resolver_.wait(deadline); }

 private:
  void run();
  bool take_posted();
  void take_servers();
  std::optional<std::size_t> find(const std::string& endpoint) const;
  void close_gone();
  void read_server(std::size_t server);
  void read_answers(std::size_t server);
  void refused(std::size_t server, const Error& why);
  void send_due();
  void end(const RequestId& id, Result<Answer> result);

  zmq::context_t context_;
  std::optional<keys::ClientKeys> keys_;
  Resolver resolver_;
  struct Server {
    std::string endpoint;
    std::unique_ptr<ServerLink> link;  ///< none: nobody has this index
  };
  std::vector<Server> servers_;  ///< by the dispatcher's indexes
  std::size_t links_n_ = 0;      ///< made so far
  Dispatcher dispatcher_;
  std::map<RequestId, Call> calls_;
  TimePoint wake_;

  int wake_fd_;
  std::mutex mutex_;
  std::vector<Call> posted_;  ///< guarded by mutex_
  bool stop_ = false;         ///< guarded by mutex_
  std::thread thread_;
};

}  // namespace graspd::client
