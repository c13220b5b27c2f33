#include "resolver.hpp"

#include <arpa/inet.h>
#include <netdb.h>
#include <netinet/in.h>
#include <sys/eventfd.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <condition_variable>
#include <mutex>
#include <stdexcept>
#include <system_error>

#include "thread_without_signals.hpp"

namespace graspd::client {
namespace {

using std::chrono::milliseconds;

/// Between lookups for lost servers and for names that had no address.
constexpr milliseconds kSoonest{1000};

constexpr std::string_view kTcp = "tcp://";

/// Where the host's name is in an endpoint that has one.
struct Name {
  std::string endpoint;
  std::string host;  ///< empty: the endpoint stands for itself
  std::string port;
  std::vector<std::string> addresses;
  std::optional<Error> error;  ///< of the last lookup
  bool is_looked_up = false;
};

bool is_port(const std::string& text) {
  const bool digits = !text.empty() && text.size() <= 5 &&
                      std::ranges::all_of(text, [](char c) { return c >= '0' && c <= '9'; });
  return digits && std::stoi(text) >= 1 && std::stoi(text) <= 65535;
}

bool is_address(const std::string& host) {
  in_addr ignored{};
  return host.starts_with('[') || inet_pton(AF_INET, host.c_str(), &ignored) == 1;
}

Name name_in(const std::string& endpoint) {
  Name name{endpoint, {}, {}, {endpoint}, {}, true};
  const std::size_t colon = endpoint.rfind(':');
  if (!endpoint.starts_with(kTcp) || colon < kTcp.size()) return name;
  std::string host = endpoint.substr(kTcp.size(), colon - kTcp.size());
  // "SOURCE;HOST:PORT" says which of our own addresses to use: libzmq's affair.
  if (host.empty() || is_address(host) || host.find(';') != std::string::npos) return name;
  name.port = endpoint.substr(colon + 1);
  if (!is_port(name.port)) {
    throw std::invalid_argument(
        fmt::format("'{}' is no server's endpoint (its port is no number from 1 to 65535); it "
                    "reads tcp://HOST:PORT, as in tcp://127.0.0.1:5555",
                    endpoint));
  }
  name.host = std::move(host);
  name.addresses.clear();
  name.is_looked_up = false;
  return name;
}

Error no_address(const Name& name, const Error& why) {
  return {Code::kUnavailable,
          fmt::format("{}: '{}' has no address ({}); check the name, and that this machine's "
                      "resolver knows it",
                      name.endpoint, name.host, why.message)};
}

}  // namespace

Result<std::vector<std::string>> addresses_of(const std::string& host) {
  addrinfo hints{};
  hints.ai_family = AF_INET;
  hints.ai_socktype = SOCK_STREAM;
  addrinfo* found = nullptr;
  if (const int error = getaddrinfo(host.c_str(), nullptr, &hints, &found)) {
    return fail(Code::kUnavailable, "{}", gai_strerror(error));
  }
  const std::unique_ptr<addrinfo, decltype(&freeaddrinfo)> owner(found, freeaddrinfo);
  std::vector<std::string> addresses;
  for (const addrinfo* info = found; info != nullptr; info = info->ai_next) {
    char text[INET_ADDRSTRLEN] = {};
    const auto* address = reinterpret_cast<const sockaddr_in*>(info->ai_addr);
    inet_ntop(AF_INET, &address->sin_addr, text, sizeof text);
    addresses.emplace_back(text);
  }
  return addresses;
}

/// Shared with the thread, which may outlive the Resolver by one lookup.
struct Resolver::State {
  explicit State(NameOptions names_options)
      : options(std::move(names_options)), fd(eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK)) {
    if (fd < 0) throw std::system_error(errno, std::generic_category(), "eventfd");
  }
  ~State() { close(fd); }
  State(const State&) = delete;
  State& operator=(const State&) = delete;

  void run();
  void looked_up(Name& name, Result<std::vector<std::string>> found);
  Directory directory() const;

  const NameOptions options;
  const int fd;
  mutable std::mutex mutex;
  mutable std::condition_variable changed;
  std::vector<Name> names;  ///< host and port never change; the rest is guarded by mutex
  bool stop = false;        ///< guarded by mutex, as is what follows
  bool is_urgent = false;
};

void Resolver::State::run() {
  std::unique_lock lock(mutex);
  while (!stop) {
    is_urgent = false;
    bool all_found = true;
    for (Name& name : names) {
      if (name.host.empty()) continue;
      lock.unlock();
      auto found = options.resolve(name.host);
      lock.lock();
      if (stop) return;
      looked_up(name, std::move(found));
      all_found = all_found && !name.error;
    }
    const TimePoint soonest = Clock::now() + kSoonest;
    const TimePoint next = all_found ? Clock::now() + options.every : soonest;
    changed.wait_until(lock, std::min(soonest, next), [&] { return stop; });
    changed.wait_until(lock, next, [&] { return stop || is_urgent; });
  }
}

/// With the lock held.
void Resolver::State::looked_up(Name& name, Result<std::vector<std::string>> found) {
  const Directory before = directory();
  const bool was_found = name.is_looked_up && !name.error;
  const bool is_first = !name.is_looked_up;
  name.is_looked_up = true;
  if (found && found->empty()) found = fail(Code::kUnavailable, "its list is empty");
  if (found) {
    std::ranges::sort(*found);
    name.addresses = *std::move(found);
    for (std::string& address : name.addresses) {
      address = fmt::format("{}{}:{}", kTcp, address, name.port);
    }
    name.error.reset();
  } else {
    name.error = no_address(name, found.error());
  }
  const Directory now = directory();
  // Where there is nobody else, the calls say it.
  if (name.error && (is_first || was_found) && options.on_warning && !now.endpoints.empty()) {
    options.on_warning(name.error->message +
                       (name.addresses.empty() ? "" : "; the addresses it had are kept"));
  }
  if (now.endpoints == before.endpoints && now.is_complete == before.is_complete &&
      now.unresolved.size() == before.unresolved.size()) {
    return;
  }
  changed.notify_all();
  eventfd_write(fd, 1);
}

/// With the lock held.
Directory Resolver::State::directory() const {
  Directory directory;
  directory.is_complete = std::ranges::all_of(names, &Name::is_looked_up);
  for (const Name& name : names) {
    if (name.addresses.empty()) {
      directory.unresolved.push_back(
          {name.endpoint, name.error.value_or(no_address(name, {{}, "still being looked up"}))});
    }
    for (const std::string& endpoint : name.addresses) {
      const bool is_known = std::ranges::count(directory.endpoints, endpoint) > 0;
      if (!is_known) directory.endpoints.push_back(endpoint);
    }
  }
  return directory;
}

Resolver::Resolver(const std::vector<std::string>& endpoints, const NameOptions& options)
    : state_(std::make_shared<State>(options)) {
  if (endpoints.empty()) throw std::invalid_argument("a client needs at least one server");
  for (const std::string& endpoint : endpoints) state_->names.push_back(name_in(endpoint));
  eventfd_write(state_->fd, 1);
  if (state_->directory().is_complete) return;
  thread_without_signals([state = state_] { state->run(); }).detach();
}

Resolver::~Resolver() {
  const std::lock_guard lock(state_->mutex);
  state_->stop = true;
  state_->changed.notify_all();
}

int Resolver::fd() const { return state_->fd; }

std::optional<Directory> Resolver::take() {
  eventfd_t ignored = 0;
  if (eventfd_read(state_->fd, &ignored) != 0) return std::nullopt;
  const std::lock_guard lock(state_->mutex);
  return state_->directory();
}

Directory Resolver::wait(TimePoint deadline) const {
  std::unique_lock lock(state_->mutex);
  const auto is_complete = [&] { return state_->directory().is_complete; };
  state_->changed.wait_until(lock, deadline, is_complete);
  return state_->directory();
}

void Resolver::look_again() {
  const std::lock_guard lock(state_->mutex);
  state_->is_urgent = true;
  state_->changed.notify_all();
}

}  // namespace graspd::client
