#include <vector>

#include "front_impl.hpp"
#include "graspd/codec/codec.hpp"

namespace graspd::service {
namespace {

std::string hex(const RequestId& id) { return fmt::format("{:02x}", fmt::join(id, "")); }

// One request, one line of the log, whatever an exception says.
std::string printable(std::string_view text) {
  std::string line(text);
  for (char& c : line) {
    if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f) c = '?';
  }
  return line;
}

double ms_between(TimePoint from, TimePoint to) {
  return std::chrono::duration<double, std::milli>(to - from).count();
}

}  // namespace

void Front::Impl::take(Message message, Door door) {
  const std::string client = message.frames[0].to_string();
  zmq::socket_t& socket = door == Door::kData ? data_ : control_;
  std::optional<std::string> key_cell;
  if (authenticator_ && message.frames.size() > 1) {
    key_cell = authenticator_->cell_of(message.frames[1]);
    if (!key_cell) {
      turn_away(socket, client);
      return;
    }
  }
  Incoming incoming = take_in(std::move(message), crew_->part_ids, door, key_cell);
  Answer reply;
  if (auto* plan = std::get_if<PlanJob>(&incoming)) {
    admit(client, std::move(*plan));
    return;
  }
  if (const auto* question = std::get_if<HealthQuestion>(&incoming)) {
    reply.id = question->id;
    reply.body = health();
  } else {
    auto& refused = std::get<Refused>(incoming);
    log(LogLevel::kInfo, "id={} code={} \"{}\"", hex(refused.id), name_of(refused.error.code),
        printable(refused.error.message));
    reply.id = refused.id;
    reply.code = refused.error.code;
    reply.message = std::move(refused.error.message);
  }
  answer(socket, client, reply);
}

void Front::Impl::admit(const std::string& client, PlanJob plan) {
  const TimePoint now = Clock::now();
  const Ticket ticket = next_ticket_++;
  Job& job = jobs_[ticket];
  job.client = client;
  job.arrived = now;
  job.deadline = now + plan.budget;
  job.plan = std::move(plan);
  if (drain_until_) {
    refuse(ticket, {Code::kDraining, "the server is shutting down; use another server"});
    return;
  }
  const Admission::Verdict verdict = admission_.admit({ticket, job.plan.cell, job.deadline}, now);
  if (verdict.superseded) {
    refuse(
        *verdict.superseded,
        {Code::kSuperseded, "a newer frame of the same cell took this one's place in the queue"});
  }
  if (verdict.refusal) refuse(ticket, verdict.refusal->error, verdict.refusal->retry_after_ms);
}

void Front::Impl::read_workers() {
  Message message;
  while (receive(workers_, 6, message)) {
    const std::string identity = message.frames[0].to_string();
    for (Crew* crew : crews()) {
      if (!crew->workers.heard(identity, Clock::now())) continue;
      hear(*crew, identity, std::move(message));
      break;
    }
  }
}

void Front::Impl::hear(Crew& crew, const std::string& identity, Message message) {
  const std::string_view what = message.frames.at(1).to_string_view();
  if (what == verb::kReady) {
    greet(crew, identity, message);
  } else if (what == verb::kDone) {
    conclude(crew, identity, std::move(message));
  }
}

void Front::Impl::greet(Crew& crew, const std::string& identity, const Message& message) {
  const ServerInfo& server = crew.facts.server;
  if (message.frames.at(2).to_string_view() != server.catalogue_hash ||
      message.frames.at(3).to_string_view() != server.config_hash) {
    // Answers of one server must not depend on which worker computed them.
    crew.workers.reject(identity,
                        "the parts on disk have changed since they were loaded; reload them "
                        "(SIGHUP)");
    return;
  }
  crew.workers.ready(identity);
  log(LogLevel::kDebug, "{} is ready", identity);
  if (!was_ready_ && crew.workers.all_ready()) {
    was_ready_ = true;
    if (options_.on_ready) options_.on_ready();
  }
}

void Front::Impl::conclude(Crew& crew, const std::string& identity, Message message) {
  const Ticket ticket = number_of(message.frames.at(2));
  const std::string_view code = message.frames.at(3).to_string_view();
  const std::string_view detail = message.frames.at(4).to_string_view();
  if (crew.workers.release(identity, Clock::now()) != ticket) {
    log(LogLevel::kError, "{} concluded a request it did not hold", identity);
    return;
  }
  // One that ran out of time has taken at least so long.
  finish(ticket, code == name_of(Code::kOk) || code == name_of(Code::kDeadlineExceeded));
  const Job& job = jobs_.at(ticket);
  if (!job.answered) {
    log_request(job.plan, code, detail, job.arrived, job.started);
    send_to_client(data_, job.client, std::move(message.frames.at(5)));
  }
  jobs_.erase(ticket);
}

void Front::Impl::expire() {
  const TimePoint now = Clock::now();
  for (const Ticket ticket : admission_.expire(now)) {
    refuse(ticket, {Code::kDeadlineExceeded, "the request's budget ended while it was queued"});
  }
  for (auto& [ticket, job] : jobs_) {
    if (job.running && !job.answered && job.deadline <= now) {
      refuse(ticket, {Code::kDeadlineExceeded, "the request's budget ended while it was computed"});
    }
  }
}

void Front::Impl::dispatch() {
  while (const auto identity = crew_->workers.idle()) {
    const TimePoint now = Clock::now();
    const std::optional<Ticket> ticket = admission_.start(now);
    if (!ticket) return;
    Job& job = jobs_.at(*ticket);
    if (job.deadline <= now) {
      finish(*ticket, false);
      refuse(*ticket, {Code::kDeadlineExceeded, "the request's budget ended while it was queued"});
    } else if (!start(job, *ticket, *identity)) {
      finish(*ticket, false);
      refuse(*ticket, {Code::kInternal, "no worker could be reached"});
      crew_->workers.reject(*identity, "it could not be reached");
    }
  }
}

bool Front::Impl::start(Job& job, Ticket ticket, const std::string& identity) {
  const TimePoint now = Clock::now();
  const auto queue_ns = std::chrono::nanoseconds(now - job.arrived).count();
  std::vector<zmq::message_t> frames;
  frames.push_back(frame_of(identity));
  frames.push_back(frame_of(verb::kPlan));
  frames.push_back(frame_of(ticket));
  frames.push_back(frame_of(static_cast<std::uint64_t>(queue_ns)));
  frames.push_back(std::move(job.plan.envelope));
  frames.push_back(std::move(job.plan.payload));
  if (send(workers_, std::move(frames)) != Sent::kYes) return false;
  crew_->workers.assign(identity, ticket, now);
  job.running = true;
  job.started = now;
  return true;
}

void Front::Impl::finish(Ticket ticket, bool computed) {
  admission_.finish(ticket, Clock::now(), computed);
}

void Front::Impl::refuse(Ticket ticket, Error error, std::uint32_t retry_after_ms) {
  const auto found = jobs_.find(ticket);
  Job& job = found->second;
  if (!job.answered) {
    const TimePoint started = job.running ? job.started : Clock::now();
    log_request(job.plan, name_of(error.code), error.message, job.arrived, started);
    Answer reply;
    reply.id = job.plan.id;
    reply.code = error.code;
    reply.message = std::move(error.message);
    reply.retry_after_ms = retry_after_ms;
    answer(data_, job.client, reply);
  }
  // A running job stays until its worker is heard of again.
  job.answered = true;
  if (!job.running) jobs_.erase(found);
}

void Front::Impl::answer(zmq::socket_t& socket, const std::string& client, const Answer& reply) {
  send_to_client(socket, client, frame_of(codec::encode_answer(reply)));
}

void Front::Impl::send_to_client(zmq::socket_t& socket, const std::string& client,
                                 zmq::message_t envelope) {
  std::vector<zmq::message_t> frames;
  frames.push_back(frame_of(client));
  frames.push_back(std::move(envelope));
  switch (send(socket, std::move(frames))) {
    case Sent::kYes:
      ++answered_n_;
      return;
    case Sent::kUnreachable:
      log(LogLevel::kInfo, "a client left before its answer");
      return;
    case Sent::kWouldBlock:
      log(LogLevel::kWarning, "a client does not read its answers");
      return;
  }
}

HealthAnswer Front::Impl::health() const {
  HealthAnswer health;
  const bool ready = was_ready_ && authenticates_ && crew_->workers.ready_n() > 0;
  health.state = drain_until_ ? ServerState::kDraining
                              : (ready ? ServerState::kReady : ServerState::kStarting);
  health.workers_n = static_cast<std::uint32_t>(crew_->workers.ready_n());
  health.workers_busy_n = static_cast<std::uint32_t>(crew_->workers.busy_n());
  health.queued_n = static_cast<std::uint32_t>(admission_.queued_n());
  health.answered_n = answered_n_;
  health.uptime_s = std::chrono::duration<double>(Clock::now() - started_).count();
  health.part_ids = crew_->facts.part_ids;
  health.server = crew_->facts.server;
  return health;
}

void Front::Impl::log_request(const PlanJob& plan, std::string_view code, std::string_view detail,
                              TimePoint arrived, TimePoint started) {
  const bool ok = code == name_of(Code::kOk);
  log(LogLevel::kInfo,
      "id={} attempt={} cell={} parts={} code={} {}{}{} queue_ms={:.1f} total_ms={:.1f}",
      hex(plan.id), plan.attempt, plan.cell, plan.parts, code, ok ? "" : "\"", printable(detail),
      ok ? "" : "\"", ms_between(arrived, started), ms_between(arrived, Clock::now()));
}

}  // namespace graspd::service
