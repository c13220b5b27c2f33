#pragma once

#include <fmt/format.h>

#include <map>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <zmq.hpp>

#include "graspd/service/admission.hpp"
#include "graspd/service/front.hpp"
#include "graspd/service/supervisor.hpp"
#include "intake.hpp"
#include "messages.hpp"

namespace graspd::service {

/// The loop and its sockets are in front.cpp, what happens to a request in front_requests.cpp.
class Front::Impl {
 public:
  Impl(FrontOptions options, WorkerLauncher& launcher);
  void run();
  std::string data_endpoint() const { return data_.get(zmq::sockopt::last_endpoint); }
  std::string control_endpoint() const { return control_.get(zmq::sockopt::last_endpoint); }

 private:
  struct Job {
    std::string client;  ///< routing id on the data socket
    PlanJob plan;
    TimePoint arrived;
    TimePoint started;
    TimePoint deadline;
    bool running = false;
    bool answered = false;  ///< true while running: the deadline came before the result
  };
  using Jobs = std::map<Ticket, Job>;

  // The loop's steps.
  bool finished();
  void wait();
  void read_stop();
  void read_control();
  void read_workers();
  void read_data();
  void tend_workers();
  void expire();
  void dispatch();
  void say_goodbye();

  // One message.
  void take(Message message, Door door);
  void admit(const std::string& client, PlanJob plan);
  void hear(const std::string& identity, Message message);
  void greet(const std::string& identity, const Message& message);
  void conclude(const std::string& identity, Message message);

  // One job.
  bool start(Job& job, Ticket ticket, const std::string& identity);
  void finish(Ticket ticket, bool computed);
  void refuse(Ticket ticket, Error error, std::uint32_t retry_after_ms = 0);
  void answer(zmq::socket_t& socket, const std::string& client, const Answer& answer);
  void send_to_client(zmq::socket_t& socket, const std::string& client, zmq::message_t envelope);
  HealthAnswer health() const;
  void log_request(const PlanJob& plan, std::string_view code, std::string_view detail,
                   TimePoint arrived, TimePoint started);

  template <class... Args>
  void log(LogLevel level, fmt::format_string<Args...> format, Args&&... args) {
    if (options_.log) options_.log(level, fmt::format(format, std::forward<Args>(args)...));
  }

  FrontOptions options_;
  std::set<std::string> part_ids_;
  zmq::context_t context_;
  zmq::socket_t data_;
  zmq::socket_t control_;
  zmq::socket_t workers_;
  Admission admission_;
  Supervisor supervisor_;
  Jobs jobs_;
  Ticket next_ticket_ = 1;
  TimePoint started_;
  std::uint64_t answered_n_ = 0;
  bool was_ready_ = false;
  std::optional<TimePoint> drain_until_;
};

}  // namespace graspd::service
