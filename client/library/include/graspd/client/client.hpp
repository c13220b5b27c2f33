#pragma once

#include <chrono>
#include <cstddef>
#include <functional>
#include <future>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "graspd/client/addresses.hpp"
#include "graspd/client/dispatcher.hpp"
#include "graspd/keys/key_files.hpp"
#include "graspd/types/answer.hpp"
#include "graspd/types/envelope.hpp"
#include "graspd/types/frame.hpp"
#include "graspd/types/request.hpp"

namespace graspd::client {

/// Writes it to the standard error output.
void print_warning(const std::string& message);

/// How endpoints with a host's name become servers: one for each of its addresses. Both functions
/// are called from a thread of the client's, and `resolve` may outlive it by one call.
struct NameOptions {
  Resolve resolve = addresses_of;
  /// How often names are looked up again; besides, within a second of losing a server, and every
  /// second while one has no address.
  std::chrono::milliseconds every{10'000};
  /// Told of a name that has no address, while there are other servers.
  std::function<void(const std::string& message)> on_warning = print_warning;
};

/// In whose name a client asks, and how.
struct ClientOptions {
  std::string cell = "default";  ///< whose turn a request counts as: one name per robot cell
  DepthEncoding encoding = DepthEncoding::kRaw;
  /// Without them only servers that are `insecure` answer. A key answers for its own cell alone.
  std::optional<keys::ClientKeys> keys;
  DispatchOptions dispatch;
  NameOptions names;
};

/// One server's answer, or why there was none.
struct ServerHealth {
  std::string endpoint;
  Result<HealthAnswer> health;
};

/// 16 random bytes.
RequestId new_request_id();

/// A frame and a request, checked and encoded: for who sends the same ones again and again. Copies
/// share the image.
struct PreparedPlan {
  PlanCall call;
  std::shared_ptr<const std::vector<std::byte>> payload;
};
/// \returns INVALID_ARGUMENT for what need not be sent to know that it is wrong.
Result<PreparedPlan> prepare(const DepthFrame& frame, const PlanRequest& request,
                             DepthEncoding encoding = DepthEncoding::kRaw);

/// How a request ended, and when.
struct PlanEnd {
  Result<PlanAnswer> answer;
  std::optional<TimePoint> sent;  ///< its first attempt, to a socket; none: no server was there
  TimePoint ended;
};

/// Asks grasp servers for plans. Servers keep nothing between requests, so any of them will do: the
/// client knows all addresses and balances itself, with no broker between.
///
/// All members may be called from any thread at once. Sockets belong to one thread inside.
class Client {
 public:
  /// Returns at once, connected or not. \param endpoints the servers' data endpoints, as
  /// "tcp://127.0.0.1:5555". A host's name stands for all of its addresses, of which each is a
  /// server; it is looked up again from time to time. Where no name has an address, calls end with
  /// UNAVAILABLE, which says so.
  /// \throws std::invalid_argument for one that is no endpoint, or none at all.
  explicit Client(const std::vector<std::string>& endpoints, ClientOptions options = {});
  ~Client();
  Client(const Client&) = delete;
  Client& operator=(const Client&) = delete;

  /// Waits for the answer, `budget` at most.
  /// \returns the server's refusals by their codes, UNAUTHENTICATED where none takes our key,
  /// UNAVAILABLE where no server is there, and
  /// INVALID_ARGUMENT for what need not be sent to know that it is wrong.
  /// \param id to find the request by in the server's log; never the same for two requests.
  Result<PlanAnswer> plan(const DepthFrame& frame, const PlanRequest& request,
                          std::chrono::milliseconds budget, const RequestId& id = new_request_id());
  /// The same without waiting. Frame and request are copied.
  std::future<Result<PlanAnswer>> submit(const DepthFrame& frame, const PlanRequest& request,
                                         std::chrono::milliseconds budget,
                                         const RequestId& id = new_request_id());

  /// Asks again what was asked before, to the bit: `plan` would change the last bits of poses.
  /// Without keys it is asked in the name of the cell that asked it then.
  /// \param envelope,depth_image a plan request and its image, as they crossed the wire
  Result<PlanAnswer> ask_again(std::string_view envelope, std::string_view depth_image,
                               std::chrono::milliseconds budget,
                               const RequestId& id = new_request_id());

  /// The same without a copy, and with a call of `done` instead of a future: once, from a thread of
  /// the client's, which it must not keep waiting.
  void submit(const PreparedPlan& plan, std::chrono::milliseconds budget, const RequestId& id,
              std::function<void(PlanEnd)> done);

  /// Asks every server once; a name that has no address is told as a server that is not there.
  std::vector<ServerHealth> health(std::chrono::milliseconds budget = std::chrono::seconds(2));

 private:
  class Loop;
  ClientOptions options_;
  std::unique_ptr<Loop> loop_;
};

}  // namespace graspd::client
