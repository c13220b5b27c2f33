#include "graspd/service/front.hpp"

#include <sys/eventfd.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <map>
#include <random>
#include <system_error>

#include "front_impl.hpp"
#include "sockets.hpp"

namespace graspd::service {
namespace {

using std::chrono::milliseconds;

// Between looks at the stop descriptor and the workers, at most this many messages of one kind.
constexpr int kMessagesPerTurn = 64;
constexpr milliseconds kLongestSleep{1000};
constexpr milliseconds kWorkersGoodbye{2000};

std::unique_ptr<Authenticator> make_authenticator(
    zmq::context_t& context, const std::optional<Authentication>& authentication) {
  if (!authentication) return nullptr;
  return std::make_unique<Authenticator>(context, authentication->server, authentication->allowed);
}

std::size_t pool_size(const ServerConfig& config) {
  return std::max<std::size_t>(1, config.workers_n);  // 0: one thread of this process
}

SupervisorLimits limits_of(const ServerConfig& config) {
  SupervisorLimits limits;
  limits.job = milliseconds(config.worker_time_limit_ms);
  return limits;
}

}  // namespace

Front::Impl::Impl(FrontOptions options, WorkerLauncher& launcher)
    : options_(std::move(options)),
      authenticator_(make_authenticator(context_, options_.authentication)),
      authenticates_(!authenticator_),
      data_lock_(options_.config.data_endpoint),
      control_lock_(options_.config.control_endpoint),
      data_(bind_data(context_, options_.config.data_endpoint, authenticator_.get())),
      control_(bind_control(context_, options_.config.control_endpoint, authenticator_.get())),
      workers_(bind_workers(context_, options_.worker_endpoint)),
      admission_(pool_size(options_.config), std::random_device{}()),
      crew_(make_crew(options_.facts, launcher)),
      loaded_fd_(eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK)),
      started_(Clock::now()),
      metrics_(options_.facts.server, options_.facts.part_ids),
      status_(started_),
      flight_recorder_(options_.config.flight_recorder) {
  if (loaded_fd_ < 0) throw std::system_error(errno, std::generic_category(), "eventfd");
  if (options_.authentication) know_cells(options_.authentication->allowed);
  const std::string& http_endpoint = options_.config.http_endpoint;
  if (!http_endpoint.empty()) http_.emplace(http_endpoint, http_pages());
}

Front::Impl::~Impl() {
  if (loading_.valid()) loading_.wait();  // it writes to the descriptor at its end
  close(loaded_fd_);
}

void Front::Impl::run() {
  test_authentication();
  while (!finished()) {
    const Woken woken = wait();
    if (woken.stop) read_stop();
    read_reload();
    tend_authentication();
    if (woken.control) read_control();
    if (woken.workers) read_workers();
    if (woken.data) read_data();
    tend_workers();
    expire();
    dispatch();
    observe();
  }
  say_goodbye();
}

bool Front::Impl::finished() {
  if (!drain_until_) return false;
  if (Clock::now() >= *drain_until_) {
    std::vector<Ticket> left;
    for (const auto& [ticket, job] : jobs_) left.push_back(ticket);
    for (const Ticket ticket : left) {
      refuse(ticket, {Code::kDraining,
                      "the server had to stop before this request was computed; "
                      "use another server"});
    }
    return true;
  }
  return std::all_of(jobs_.begin(), jobs_.end(),
                     [](const auto& job) { return job.second.answered; });
}

std::unique_ptr<Front::Impl::Crew> Front::Impl::make_crew(ServerFacts facts,
                                                          WorkerLauncher& launcher) {
  std::set<std::string> part_ids(facts.part_ids.begin(), facts.part_ids.end());
  Supervisor workers(pool_size(options_.config), options_.worker_endpoint, launcher,
                     limits_of(options_.config), fmt::format("worker-{}", ++crews_n_));
  return std::make_unique<Crew>(
      Crew{std::move(facts), std::move(part_ids), nullptr, std::move(workers)});
}

Front::Impl::Woken Front::Impl::wait() {
  std::vector<zmq::pollitem_t> items{{data_.handle(), 0, ZMQ_POLLIN, 0},
                                     {control_.handle(), 0, ZMQ_POLLIN, 0},
                                     {workers_.handle(), 0, ZMQ_POLLIN, 0},
                                     {nullptr, options_.stop_fd, ZMQ_POLLIN, 0}};
  for (const int fd : {options_.reload_fd, loaded_fd_}) {
    if (fd >= 0) items.push_back({nullptr, fd, ZMQ_POLLIN, 0});
  }
  const TimePoint now = Clock::now();
  TimePoint wake = now + kLongestSleep;
  for (Crew* crew : crews()) {
    wake = std::min(wake, crew->workers.next_tend());
    for (const int fd : crew->workers.exit_fds()) items.push_back({nullptr, fd, ZMQ_POLLIN, 0});
  }
  if (const auto deadline = admission_.earliest_deadline()) wake = std::min(wake, *deadline);
  if (drain_until_) wake = std::min(wake, *drain_until_);
  for (const auto& [ticket, job] : jobs_) {
    if (!job.answered) wake = std::min(wake, job.deadline);
  }
  // A millisecond later rather than a busy turn before.
  poll(items, std::max(milliseconds(0), std::chrono::ceil<milliseconds>(wake - now)));
  const auto readable = [&](std::size_t item) { return (items[item].revents & ZMQ_POLLIN) != 0; };
  return {readable(0), readable(1), readable(2), readable(3)};
}

void Front::Impl::read_stop() {
  if (!read_event(options_.stop_fd)) return;
  const bool again = drain_until_.has_value();
  const milliseconds limit(again ? 0 : options_.config.drain_limit_ms);
  drain_until_ = Clock::now() + limit;
  log(LogLevel::kInfo, "{}: {} requests queued, {} running",
      again ? "stopping at once" : "draining", admission_.queued_n(), admission_.running_n());
}

void Front::Impl::read_control() {
  Message message;
  for (int i = 0; i < kMessagesPerTurn && receive(control_, kMostFrames, message); ++i) {
    take(std::move(message), Door::kControl);
  }
}

void Front::Impl::read_data() {
  Message message;
  for (int i = 0; i < kMessagesPerTurn && receive(data_, kMostFrames, message); ++i) {
    take(std::move(message), Door::kData);
  }
}

void Front::Impl::tend_workers() {
  take_turns();
  for (Crew* crew : crews()) {
    if (crew == next_crew_.get()) continue;
    try {
      tend(*crew);
    } catch (const std::runtime_error&) {
      // While other parts are being loaded, workers may be unfit for no other reason than that.
      if (!changing_parts() && !reload_again_) throw;
    }
  }
}

void Front::Impl::tend(Crew& crew) {
  const Supervisor::Report report = crew.workers.tend(Clock::now());
  for (const std::string& notice : report.notices) {
    log(LogLevel::kWarning, "{}", notice);
    metrics_.worker_lost();
    last_loss_ = notice;
  }
  for (const Supervisor::Lost& lost : report.lost) {
    const std::uint64_t content = jobs_.at(lost.ticket).plan.content;
    finish(lost.ticket, false);
    refuse(lost.ticket, {Code::kInternal,
                         fmt::format("the worker that computed this request was lost ({}); other "
                                     "requests are not affected",
                                     lost.reason)});
    if (poison_.add_death(content)) {
      log(LogLevel::kWarning, "that request is poison: it is refused from now on");
    }
    jobs_.erase(lost.ticket);
  }
}

void Front::Impl::say_goodbye() {
  next_crew_.reset();
  for (Crew* crew : crews()) {
    for (const std::string& identity : crew->workers.identities()) say_stop(identity);
    // A worker that still computes would not hear it; it is ended with its handle.
    const bool all_hear = crew->workers.busy_n() == 0;
    const TimePoint until = Clock::now() + (all_hear ? kWorkersGoodbye : milliseconds(0));
    for (const int fd : crew->workers.exit_fds()) {
      std::vector<zmq::pollitem_t> items{{nullptr, fd, ZMQ_POLLIN, 0}};
      poll(items, std::max(milliseconds(0),
                           std::chrono::duration_cast<milliseconds>(until - Clock::now())));
    }
  }
  // Answers that are still in the sockets get a second to leave.
  data_.set(zmq::sockopt::linger, 1000);
  control_.set(zmq::sockopt::linger, 1000);
  log(LogLevel::kInfo, "stopped after {} answers", answered_n_);
}

Front::Front(FrontOptions options, WorkerLauncher& launcher)
    : impl_(std::make_unique<Impl>(std::move(options), launcher)) {}
Front::~Front() = default;
std::string Front::data_endpoint() const { return impl_->data_endpoint(); }
std::string Front::control_endpoint() const { return impl_->control_endpoint(); }
std::string Front::http_url() const { return impl_->http_url(); }
void Front::run() { impl_->run(); }

}  // namespace graspd::service
