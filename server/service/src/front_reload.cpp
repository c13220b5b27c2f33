#include <sys/eventfd.h>

#include <stdexcept>

#include "front_impl.hpp"

namespace graspd::service {
namespace {

// Between two looks at who was refused, and at whether the thread that refuses is alive.
constexpr std::chrono::milliseconds kAuthenticationInterval{500};

}  // namespace

void Front::Impl::test_authentication() {
  if (!authenticator_) return;
  for (const std::string& endpoint : {data_endpoint(), control_endpoint()}) {
    if (const auto tested = authenticator_->test(endpoint); !tested) {
      throw std::runtime_error(
          fmt::format("authentication does not work, so that this server does not start: {}",
                      tested.error().message));
    }
  }
  authenticates_ = true;
  const keys::AllowList& allowed = options_.authentication->allowed;
  for (const std::string& fault : allowed.faults()) log(LogLevel::kWarning, "{}", fault);
  if (allowed.entries().empty()) {
    log(LogLevel::kWarning,
        "no cell is allowed yet: 'grasp keys allow' one, then reload with SIGHUP");
  }
}

void Front::Impl::tend_authentication() {
  const TimePoint now = Clock::now();
  if (!authenticator_ || now - authentication_looked_at_ < kAuthenticationInterval) return;
  authentication_looked_at_ = now;
  const Authenticator::News news = authenticator_->news();
  for (const std::string& notice : news.notices) log(LogLevel::kWarning, "{}", notice);
  metrics_.auth_failed(AuthFailure::kUnknownKey, news.refused_n);
  const bool alive = authenticator_->alive();
  if (authenticates_ && !alive) {
    log(LogLevel::kError,
        "authentication does not answer: not ready, and no client is let in; restart the server");
  } else if (!authenticates_ && alive) {
    log(LogLevel::kInfo, "authentication answers again");
  }
  authenticates_ = alive;
}

void Front::Impl::know_cells(const keys::AllowList& allowed) {
  for (const keys::PublicKey& key : allowed.entries()) metrics_.know(key.cell);
}

void Front::Impl::read_reload() {
  if (read_event(options_.reload_fd) && !drain_until_) {
    // Keys first and at once: a part file that is wrong keeps no revoked key in.
    reload_allowed_cells();
    reload_again_ = true;
  }
  read_loaded();
  if (reload_again_ && !changing_parts()) {
    reload_again_ = false;
    load_parts();
  }
}

void Front::Impl::reload_allowed_cells() {
  if (!authenticator_) return;
  auto allowed = keys::AllowList::read(options_.config.allowed_cells);
  if (!allowed) {
    log(LogLevel::kError, "reload: {}; the cells allowed so far stay allowed",
        allowed.error().message);
    return;
  }
  for (const std::string& fault : allowed->faults()) log(LogLevel::kWarning, "reload: {}", fault);
  know_cells(*allowed);
  log(LogLevel::kInfo, "reload: {} keys are allowed", allowed->entries().size());
  authenticator_->replace(*std::move(allowed));
}

void Front::Impl::load_parts() {
  if (!options_.load_parts) return;
  log(LogLevel::kInfo, "reload: loading the parts");
  loading_ = std::async(std::launch::async, [this]() -> Result<NewParts> {
    // However it ends, the loop is told.
    const std::unique_ptr<const int, void (*)(const int*)> tell(
        &loaded_fd_, [](const int* fd) { eventfd_write(*fd, 1); });
    try {
      return options_.load_parts();
    } catch (const std::exception& error) {
      return fail(Code::kInternal, "{}", error.what());
    }
  });
}

void Front::Impl::read_loaded() {
  if (!loading_.valid() || !read_event(loaded_fd_)) return;
  Result<NewParts> loaded = loading_.get();
  if (!loaded) {
    log(LogLevel::kError, "reload: the parts in force stay, since the new ones are wrong: {}",
        loaded.error().message);
    return;
  }
  if (loaded->facts.server.catalogue_hash == crew_->facts.server.catalogue_hash) {
    log(LogLevel::kInfo, "reload: the parts have not changed");
    return;
  }
  next_crew_ = make_crew(std::move(loaded->facts), *loaded->launcher);
  next_crew_->launcher = std::move(loaded->launcher);
}

/// The next crew works as soon as all of it is ready; until then the present one does.
void Front::Impl::take_turns() {
  if (next_crew_) {
    try {
      tend(*next_crew_);
    } catch (const std::runtime_error& error) {
      log(LogLevel::kError, "reload: the parts in force stay: {}", error.what());
      next_crew_.reset();
      return;
    }
    if (next_crew_->workers.all_ready()) {
      last_crew_ = std::exchange(crew_, std::move(next_crew_));
      last_crew_->workers.retire();
      metrics_.serve(crew_->facts.server, crew_->facts.part_ids);
      log(LogLevel::kInfo, "reload: {} parts in force, catalogue {}", crew_->part_ids.size(),
          crew_->facts.server.catalogue_hash);
    }
  }
  retire_last_crew();
}

/// Who computes goes on; who has finished is told to stop.
void Front::Impl::retire_last_crew() {
  if (!last_crew_) return;
  while (const auto identity = last_crew_->workers.idle()) {
    say_stop(*identity);
    last_crew_->workers.dismiss(*identity, Clock::now());
  }
  if (last_crew_->workers.identities().empty()) last_crew_.reset();
}

std::vector<Front::Impl::Crew*> Front::Impl::crews() const {
  std::vector<Crew*> crews;
  for (Crew* crew : {crew_.get(), next_crew_.get(), last_crew_.get()}) {
    if (crew != nullptr) crews.push_back(crew);
  }
  return crews;
}

void Front::Impl::say_stop(const std::string& identity) {
  std::vector<zmq::message_t> frames;
  frames.push_back(frame_of(identity));
  frames.push_back(frame_of(verb::kStop));
  (void)send(workers_, std::move(frames));
}

}  // namespace graspd::service
