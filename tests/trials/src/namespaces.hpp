#pragma once

#include <functional>
#include <string>

namespace graspd::trials {

/// A network of its own, as a machine has it. Nothing of it is seen outside, and it is gone with
/// the object and the processes that were started in it. Needs root.
class NetworkNamespace {
 public:
  /// \throws std::system_error
  NetworkNamespace();
  ~NetworkNamespace();
  NetworkNamespace(const NetworkNamespace&) = delete;
  NetworkNamespace& operator=(const NetworkNamespace&) = delete;

  /// Runs `work` in it: threads and processes that it starts are in it, too.
  void in(const std::function<void()>& work) const;
  /// Runs a command of the shell in it. \throws std::runtime_error where it fails.
  void run(const std::string& command) const;
  /// For `ip link … netns`.
  std::string path() const;

 private:
  int fd_ = -1;
};

}  // namespace graspd::trials
