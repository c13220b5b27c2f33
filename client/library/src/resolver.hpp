#pragma once

#include <chrono>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "graspd/client/addresses.hpp"
#include "graspd/client/client.hpp"

namespace graspd::client {

/// Which servers the endpoints of a client stand for now.
struct Directory {
  struct Unresolved {
    std::string endpoint;
    Error error;
  };
  std::vector<std::string> endpoints;  ///< with addresses in place of names, none twice
  std::vector<Unresolved> unresolved;  ///< names that have had no address so far
  bool is_complete = false;            ///< every name has been looked up
};

/// Looks the names in endpoints up, again and again, on a thread of its own: a name may stand for
/// many servers, and for others tomorrow. A name that can't be looked up any more keeps the
/// addresses it had. Without names there is no thread. The lookups of the system can't be
/// interrupted: a thread that is within one when its Resolver goes ends by itself.
class Resolver {
 public:
  /// \throws std::invalid_argument for none, and for one whose host is a name and port no number
  Resolver(const std::vector<std::string>& endpoints, const NameOptions& options);
  ~Resolver();
  Resolver(const Resolver&) = delete;
  Resolver& operator=(const Resolver&) = delete;

  /// Readable when there is something to take.
  int fd() const;
  /// What has changed since the last time.
  std::optional<Directory> take();
  /// What is known once every name has been looked up, or at the deadline.
  Directory wait(TimePoint deadline) const;
  /// A server was lost: names may stand for others now.
  void look_again();

 private:
  struct State;
  std::shared_ptr<State> state_;
};

}  // namespace graspd::client
