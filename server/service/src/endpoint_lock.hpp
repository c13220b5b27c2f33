#pragma once

#include <string>

namespace graspd::service {

/// Keeps a second server off an ipc endpoint, where libzmq would take the socket away from the
/// first without a word. tcp needs none: there the system refuses. The file PATH.lock stays; the
/// lock goes with the process.
class EndpointLock {
 public:
  /// \throws CannotListen where another server holds it.
  explicit EndpointLock(const std::string& endpoint);
  ~EndpointLock();
  EndpointLock(const EndpointLock&) = delete;
  EndpointLock& operator=(const EndpointLock&) = delete;

 private:
  int fd_ = -1;
};

}  // namespace graspd::service
