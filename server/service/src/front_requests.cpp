#include <algorithm>
#include <vector>

#include "front_impl.hpp"
#include "graspd/codec/codec.hpp"

namespace graspd::service {
namespace {

// Of one request: a client may reconnect and ask again, but not without end.
constexpr std::size_t kMostMessages_n = 16;

}  // namespace

void Front::Impl::take(Message message, Door door) {
  const std::string client = message.frames[0].to_string();
  zmq::socket_t& socket = door == Door::kData ? data_ : control_;
  std::optional<std::string> key_cell;
  if (authenticator_ && message.frames.size() > 1) {
    key_cell = authenticator_->cell_of(message.frames[1]);
    if (!key_cell) {
      // Revoked while its client was connected. What it sent is not looked at, hence no request id.
      metrics_.auth_failed(AuthFailure::kRevokedKey);
      refuse(socket, client,
             {{},
              {},
              {Code::kUnauthenticated,
               "this key is not allowed any more; ask who runs the server for another one"}});
      return;
    }
  }
  Incoming incoming = take_in(std::move(message), crew_->part_ids, door, key_cell);
  if (auto* plan = std::get_if<PlanJob>(&incoming)) {
    admit(client, std::move(*plan));
  } else if (const auto* question = std::get_if<HealthQuestion>(&incoming)) {
    Answer reply;
    reply.id = question->id;
    reply.body = health();
    answer(socket, client, reply);
  } else {
    auto& refused = std::get<Refused>(incoming);
    if (refused.error.code == Code::kUnauthenticated) {
      metrics_.auth_failed(AuthFailure::kWrongCell);
    }
    refuse(socket, client, std::move(refused));
  }
}

void Front::Impl::refuse(zmq::socket_t& socket, const std::string& client, Refused refused) {
  log_json(LogLevel::kInfo, log_line(refused));
  metrics_.answered(refused.cell, refused.error.code, std::chrono::nanoseconds(0));
  Answer reply;
  reply.id = refused.id;
  reply.code = refused.error.code;
  reply.message = std::move(refused.error.message);
  answer(socket, client, reply);
}

void Front::Impl::admit(const std::string& client, PlanJob plan) {
  if (attach(client, plan)) return;
  if (poison_.contains(plan.content)) {
    refuse(data_, client,
           {plan.id,
            std::move(plan.cell),
            {Code::kRejectedPoison,
             fmt::format("{} workers were lost while they computed this very request; take a new "
                         "frame, and report this one with its id",
                         PoisonList::kDeaths_n)}});
    return;
  }
  const TimePoint now = Clock::now();
  const Ticket ticket = next_ticket_++;
  Job& job = jobs_[ticket];
  job.clients = {client};
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

/// A request whose id is queued or running is not computed twice: its sender hears what becomes of
/// the first. \returns whether there is nothing more to do.
bool Front::Impl::attach(const std::string& client, const PlanJob& plan) {
  const auto found = std::find_if(jobs_.begin(), jobs_.end(), [&](const auto& ticket_and_job) {
    const Job& job = ticket_and_job.second;
    return !job.answered && job.plan.id == plan.id;
  });
  if (found == jobs_.end()) return false;
  Job& job = found->second;
  if (job.plan.content != plan.content) {
    refuse(data_, client,
           {plan.id,
            plan.cell,
            {Code::kInvalidArgument,
             "id: another request with this id is being computed; take 16 new random bytes"}});
  } else if (job.clients.size() >= kMostMessages_n) {
    refuse(data_, client,
           {plan.id,
            plan.cell,
            {Code::kInvalidArgument,
             fmt::format("id: {} messages with this id wait for its answer; wait too",
                         kMostMessages_n)}});
  } else {
    job.clients.push_back(client);
  }
  return true;
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
  } else if (what == verb::kUnfit) {
    crew.workers.reject(identity, message.frames.at(2).to_string());
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
  const Code code = parse_enum<Code>(message.frames.at(3).to_string_view()).value();
  if (crew.workers.release(identity, Clock::now()) != ticket) {
    log(LogLevel::kError, "{} concluded a request it did not hold", identity);
    return;
  }
  // One that ran out of time has taken at least so long.
  finish(ticket, code == Code::kOk || code == Code::kDeadlineExceeded);
  Job& job = jobs_.at(ticket);
  if (!job.answered) {
    send_to_clients(job, message.frames.at(5));  // first: nobody waits for log and record
    tell(job, code, decode_work_report(message.frames.at(4).to_string_view()));
    keep(job, std::move(message.frames.at(5)));
  }
  jobs_.erase(ticket);
}

void Front::Impl::expire() {
  const TimePoint now = Clock::now();
  for (const Ticket ticket : admission_.expire(now)) {
    refuse(ticket, {Code::kDeadlineExceeded, "the request's budget ended while it was queued"});
  }
  for (auto& [ticket, job] : jobs_) {
    if (job.crew && !job.answered && job.deadline <= now) {
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
  if (flight_recorder_.is_on()) {
    job.kept_envelope.copy(job.plan.envelope);
    job.kept_payload.copy(job.plan.payload);
  }
  std::vector<zmq::message_t> frames;
  frames.push_back(frame_of(identity));
  frames.push_back(frame_of(verb::kPlan));
  frames.push_back(frame_of(ticket));
  frames.push_back(frame_of(static_cast<std::uint64_t>(queue_ns)));
  frames.push_back(std::move(job.plan.envelope));
  frames.push_back(std::move(job.plan.payload));
  if (send(workers_, std::move(frames)) != Sent::kYes) return false;
  crew_->workers.assign(identity, ticket, now);
  job.crew = crew_.get();
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
    tell(job, error.code, {error.message, std::nullopt, 0, 0, {}});
    Answer reply;
    reply.id = job.plan.id;
    reply.code = error.code;
    reply.message = std::move(error.message);
    reply.retry_after_ms = retry_after_ms;
    zmq::message_t envelope = frame_of(codec::encode_answer(reply));
    send_to_clients(job, envelope);
    keep(job, std::move(envelope));
  }
  // A running job stays until its worker is heard of again.
  job.answered = true;
  if (!job.crew) jobs_.erase(found);
}

void Front::Impl::answer(zmq::socket_t& socket, const std::string& client, const Answer& reply) {
  send_to_client(socket, client, frame_of(codec::encode_answer(reply)));
}

void Front::Impl::send_to_clients(const Job& job, zmq::message_t& envelope) {
  for (const std::string& client : job.clients) {
    zmq::message_t shared;
    shared.copy(envelope);
    send_to_client(data_, client, std::move(shared));
  }
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

}  // namespace graspd::service
