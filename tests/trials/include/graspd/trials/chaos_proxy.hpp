#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>

namespace graspd::trials {

/// What a network does to bytes.
struct Chaos {
  std::chrono::milliseconds delay{0};  ///< of every byte, each way
  std::size_t chop_bytes = 0;          ///< at most so many in one write; 0: as they come
  double corrupt_share = 0;            ///< of what is read at once: one bit of it is turned over
  bool stalled = false;                ///< nothing passes, nothing is lost
};

/// A TCP proxy on loopback between a client and a server, which treats them as told. It knows
/// nothing of what it carries. All members may be called from any thread.
class ChaosProxy {
 public:
  /// \param target tcp://127.0.0.1:PORT
  /// \throws std::runtime_error where there is no port to listen on.
  ChaosProxy(const std::string& target, std::uint64_t seed);
  ~ChaosProxy();
  ChaosProxy(const ChaosProxy&) = delete;
  ChaosProxy& operator=(const ChaosProxy&) = delete;

  std::string endpoint() const;
  /// For what is read from now on.
  void set(const Chaos& chaos);
  /// Ends every connection with a RST, and with it what is on its way.
  void reset_connections();
  std::size_t connections_n() const;
  /// Since the start, both ways.
  std::uint64_t passed_bytes() const;

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace graspd::trials
