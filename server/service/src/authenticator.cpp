#include "authenticator.hpp"

#include <fmt/format.h>
#include <pthread.h>
#include <sys/eventfd.h>
#include <unistd.h>

#include <cerrno>
#include <system_error>
#include <utility>

#include "handshake_probe.hpp"
#include "messages.hpp"

namespace graspd::service {
namespace {

using std::chrono::milliseconds;

// In libzmq 4.3.4, but in its header only where drafts are on.
constexpr int kZapEnforceDomain = 93;

constexpr const char* kZapAddress = "inproc://zeromq.zap.01";
constexpr std::string_view kZapVersion = "1.0";
constexpr std::string_view kDomain = "graspd";
constexpr std::string_view kProbeUser = "graspd self-test";
constexpr std::size_t kZapFrames = 7;
constexpr std::size_t kKey_bytes = 32;
constexpr std::size_t kMostNotices = 8;
constexpr int kMostMissed = 3;

std::string z85(const zmq::message_t& key) {
  char text[41];
  zmq_z85_encode(text, static_cast<const std::uint8_t*>(key.data()), kKey_bytes);
  return text;
}

}  // namespace

Authenticator::Authenticator(zmq::context_t& context, keys::KeyPair server, keys::AllowList allowed)
    : server_(std::move(server)),
      probe_(keys::make_key_pair("probe")),
      stranger_(keys::make_key_pair("stranger")),
      allowed_(std::make_shared<const keys::AllowList>(std::move(allowed))),
      handler_(context, zmq::socket_type::rep),
      pulse_(context, zmq::socket_type::dealer),
      stop_fd_(eventfd(0, EFD_CLOEXEC)) {
  if (stop_fd_ < 0) throw std::system_error(errno, std::generic_category(), "eventfd");
  handler_.set(zmq::sockopt::linger, 0);
  handler_.bind(kZapAddress);
  pulse_.set(zmq::sockopt::linger, 0);
  pulse_.connect(kZapAddress);
  thread_ = std::thread([this] { run(); });
  pthread_setname_np(thread_.native_handle(), "zap");
}

Authenticator::~Authenticator() {
  eventfd_write(stop_fd_, 1);
  thread_.join();
  close(stop_fd_);
}

void Authenticator::protect(zmq::socket_t& socket) const {
  socket.set(zmq::sockopt::curve_server, true);
  socket.set(zmq::sockopt::curve_secretkey, server_.secret_key);
  socket.set(zmq::sockopt::zap_domain, kDomain);
  const int on = 1;
  if (zmq_setsockopt(socket.handle(), kZapEnforceDomain, &on, sizeof on) != 0) {
    throw std::runtime_error(
        "this machine's libzmq can't refuse clients while nobody says who they are (option 93, "
        "ZMQ_ZAP_ENFORCE_DOMAIN); install Debian 12's libzmq5");
  }
}

Result<void> Authenticator::test(const std::string& endpoint) const {
  const Handshake stranger = try_handshake(endpoint, server_.public_key, stranger_);
  if (stranger == Handshake::kAccepted) {
    return fail(Code::kInternal, "{} lets in a client whose key nobody has allowed", endpoint);
  }
  if (stranger != Handshake::kRefused) {
    return fail(Code::kInternal, "{} does not answer a client whose key nobody has allowed",
                endpoint);
  }
  if (try_handshake(endpoint, server_.public_key, probe_) != Handshake::kAccepted) {
    return fail(Code::kInternal, "{} does not let in a client whose key is allowed", endpoint);
  }
  return {};
}

void Authenticator::replace(keys::AllowList allowed) {
  auto replacement = std::make_shared<const keys::AllowList>(std::move(allowed));
  const std::lock_guard lock(mutex_);
  allowed_ = std::move(replacement);
}

Authenticator::Lists Authenticator::allowed() const {
  const std::lock_guard lock(mutex_);
  return allowed_;
}

std::optional<std::string> Authenticator::cell_of(const zmq::message_t& envelope) const {
  // The C function: the C++ one throws where there is none.
  const char* user = zmq_msg_gets(envelope.handle(), "User-Id");
  if (user == nullptr) return std::nullopt;
  const Lists list = allowed();
  const auto cell = list->cell_of(user);
  if (!cell) return std::nullopt;
  return std::string(*cell);
}

void Authenticator::run() {
  std::vector<zmq::pollitem_t> items{{handler_.handle(), 0, ZMQ_POLLIN, 0},
                                     {nullptr, stop_fd_, ZMQ_POLLIN, 0}};
  try {
    while (true) {
      poll(items, milliseconds(-1));
      if ((items[1].revents & ZMQ_POLLIN) != 0) return;
      if ((items[0].revents & ZMQ_POLLIN) != 0) answer_one();
    }
  } catch (const std::exception& error) {
    const std::lock_guard lock(mutex_);
    news_.notices.push_back(fmt::format("authentication has ended: {}", error.what()));
  }
}

/// version, request id, domain, address, identity, mechanism, credentials →
/// version, request id, status code, status text, user id, metadata
void Authenticator::answer_one() {
  Message request;
  if (!receive(handler_, kZapFrames, request)) return;
  const auto& frames = request.frames;
  const bool understood = request.arrived_n == kZapFrames &&
                          frames[0].to_string_view() == kZapVersion &&
                          frames[2].to_string_view() == kDomain &&
                          frames[5].to_string_view() == "CURVE" && frames[6].size() == kKey_bytes;
  const std::string key = understood ? z85(frames[6]) : "";
  const std::optional<std::string> user = understood ? user_of(key) : std::nullopt;
  // A question that is not understood is our own, for a sign of life.
  if (understood && !user && key != stranger_.public_key) note_refusal(frames[3].to_string());

  std::vector<zmq::message_t> reply;
  reply.push_back(frame_of(kZapVersion));
  reply.push_back(frame_of(frames.size() > 1 ? frames[1].to_string_view() : ""));
  reply.push_back(frame_of(user ? "200" : "400"));
  reply.push_back(frame_of(user ? "OK" : "this key is not allowed"));
  reply.push_back(frame_of(user.value_or("")));
  reply.push_back(frame_of(""));
  (void)send(handler_, std::move(reply));
}

/// What libzmq attaches to every frame that comes in under this key: the key itself, since a cell
/// may have several, each of which may be revoked.
std::optional<std::string> Authenticator::user_of(const std::string& key) const {
  if (key == probe_.public_key) return std::string(kProbeUser);
  if (!allowed()->cell_of(key)) return std::nullopt;
  return key;
}

void Authenticator::note_refusal(const std::string& address) {
  const std::lock_guard lock(mutex_);
  if (++news_.refused_n > kMostNotices) return;
  news_.notices.push_back(
      fmt::format("a client at {} was refused: its key is not allowed", address));
}

Authenticator::News Authenticator::news() {
  const std::lock_guard lock(mutex_);
  if (news_.refused_n > kMostNotices) {
    news_.notices.push_back(
        fmt::format("{} more clients were refused", news_.refused_n - kMostNotices));
  }
  return std::exchange(news_, {});
}

bool Authenticator::alive() {
  Message reply;
  while (receive(pulse_, kZapFrames, reply)) {
    asking_ = false;
    missed_n_ = 0;
  }
  // Not one question upon another to a thread that does not answer; and calls are counted, not
  // time, of which much may pass where the whole process was stopped.
  if (asking_) {
    ++missed_n_;
  } else {
    asking_ = true;
    std::vector<zmq::message_t> question;
    question.push_back(frame_of(""));  // the delimiter that a REP expects
    question.push_back(frame_of(kZapVersion));
    question.push_back(frame_of("pulse"));
    (void)send(pulse_, std::move(question));
  }
  return missed_n_ < kMostMissed;
}

}  // namespace graspd::service
