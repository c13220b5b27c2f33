#pragma once

#include <fmt/format.h>

#include <future>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>
#include <zmq.hpp>

#include "authenticator.hpp"
#include "endpoint_lock.hpp"
#include "flight_recorder.hpp"
#include "graspd/service/admission.hpp"
#include "graspd/service/front.hpp"
#include "graspd/service/metrics.hpp"
#include "graspd/service/supervisor.hpp"
#include "http_endpoint.hpp"
#include "intake.hpp"
#include "log_line.hpp"
#include "messages.hpp"
#include "poison_list.hpp"
#include "status.hpp"

namespace graspd::service {

/// The loop and its sockets are in front.cpp, what happens to a request in front_requests.cpp, who
/// may come in and reloading in front_reload.cpp, what is told of it all in front_observe.cpp.
class Front::Impl {
 public:
  Impl(FrontOptions options, WorkerLauncher& launcher);
  ~Impl();
  void run();
  std::string data_endpoint() const { return data_.get(zmq::sockopt::last_endpoint); }
  std::string control_endpoint() const { return control_.get(zmq::sockopt::last_endpoint); }
  std::string http_url() const { return http_ ? http_->url() : ""; }

 private:
  /// Workers that have loaded the same parts.
  struct Crew {
    ServerFacts facts;
    std::set<std::string> part_ids;
    std::unique_ptr<WorkerLauncher> launcher;  ///< null: the caller's
    Supervisor workers;
  };
  struct Job {
    std::vector<std::string> clients;  ///< routing ids on the data socket, one for each message
    PlanJob plan;
    TimePoint arrived;
    TimePoint started;
    TimePoint deadline;
    const Crew* crew = nullptr;  ///< that it is computed by; null: it waits
    bool answered = false;       ///< true while running: the deadline came before the result
    /// Where there is a flight recorder, to be kept by it: shared with the worker's.
    zmq::message_t kept_envelope;
    zmq::message_t kept_payload;
    std::string flight;  ///< its name, where it is kept
  };
  using Jobs = std::map<Ticket, Job>;
  /// Where something is to be read: each look at a socket or descriptor is a call of the kernel.
  struct Woken {
    bool data = false;
    bool control = false;
    bool workers = false;
    bool stop = false;
  };

  // The loop's steps.
  bool finished();
  Woken wait();
  void read_stop();
  void read_control();
  void read_workers();
  void read_data();
  void tend_workers();
  void expire();
  void dispatch();
  void observe();
  void say_goodbye();

  // Who may come in.
  void test_authentication();
  void tend_authentication();
  void know_cells(const keys::AllowList& allowed);

  // Reloading: crews take turns; the last one finishes what it has.
  void read_reload();
  void reload_allowed_cells();
  void load_parts();
  void read_loaded();
  void take_turns();
  void retire_last_crew();
  bool changing_parts() const { return loading_.valid() || next_crew_ || last_crew_; }
  std::unique_ptr<Crew> make_crew(ServerFacts facts, WorkerLauncher& launcher);
  std::vector<Crew*> crews() const;
  void tend(Crew& crew);
  void say_stop(const std::string& identity);

  // One message.
  void take(Message message, Door door);
  void admit(const std::string& client, PlanJob plan);
  bool attach(const std::string& client, const PlanJob& plan);
  void hear(Crew& crew, const std::string& identity, Message message);
  void greet(Crew& crew, const std::string& identity, const Message& message);
  void conclude(Crew& crew, const std::string& identity, Message message);

  // One job.
  bool start(Job& job, Ticket ticket, const std::string& identity);
  void finish(Ticket ticket, bool computed);
  void refuse(Ticket ticket, Error error, std::uint32_t retry_after_ms = 0);
  void refuse(zmq::socket_t& socket, const std::string& client, Refused refused);
  void answer(zmq::socket_t& socket, const std::string& client, const Answer& answer);
  void send_to_clients(const Job& job, zmq::message_t& envelope);
  void send_to_client(zmq::socket_t& socket, const std::string& client, zmq::message_t envelope);

  // What is told of it all.
  Phase phase() const;
  std::optional<std::string> why_not_ready() const;
  std::optional<std::string> why_not_alive() const;
  HealthAnswer health() const;
  HttpPages http_pages();
  void tell(Job& job, Code code, WorkReport report);
  bool is_to_be_kept(const Job& job, Code code) const;
  void keep(Job& job, zmq::message_t answer);

  template <class... Args>
  void log(LogLevel level, fmt::format_string<Args...> format, Args&&... args) {
    log_json(level, log_line(fmt::format(format, std::forward<Args>(args)...)));
  }
  void log_json(LogLevel level, const std::string& line) {
    if (options_.log) options_.log(level, line);
  }

  FrontOptions options_;
  zmq::context_t context_;
  std::unique_ptr<Authenticator> authenticator_;  // before the sockets: it listens first
  bool authenticates_;  ///< has passed its test, and answers; true where there are no keys
  TimePoint authentication_looked_at_;
  EndpointLock data_lock_;
  EndpointLock control_lock_;
  zmq::socket_t data_;
  zmq::socket_t control_;
  zmq::socket_t workers_;
  Admission admission_;
  std::uint32_t crews_n_ = 0;
  std::unique_ptr<Crew> crew_;
  std::unique_ptr<Crew> next_crew_;  // loading the new parts
  std::unique_ptr<Crew> last_crew_;  // finishing what it computes
  bool reload_again_ = false;
  std::future<Result<NewParts>> loading_;
  int loaded_fd_;
  Jobs jobs_;
  PoisonList poison_;
  Ticket next_ticket_ = 1;
  TimePoint started_;
  std::uint64_t answered_n_ = 0;
  bool was_ready_ = false;
  std::optional<TimePoint> drain_until_;
  Metrics metrics_;
  Status status_;
  FlightRecorder flight_recorder_;
  std::string last_loss_;       ///< why the last worker ended
  TimePoint memory_looked_at_;  ///< and what was seen then:
  std::uint64_t front_memory_bytes_ = 0;
  std::uint64_t workers_memory_bytes_ = 0;
  std::optional<HttpEndpoint> http_;  ///< last: its threads look at the others
};

}  // namespace graspd::service
