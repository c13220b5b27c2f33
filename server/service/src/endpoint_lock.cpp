#include "endpoint_lock.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

#include "graspd/service/endpoint.hpp"
#include "graspd/service/front.hpp"

namespace graspd::service {

EndpointLock::EndpointLock(const std::string& endpoint) {
  const auto parsed = parse_endpoint(endpoint);
  // A path that begins with @ is no file, and the system refuses a second one.
  if (!parsed || parsed->path.empty() || parsed->path.front() == '@') return;
  const std::string file = parsed->path + ".lock";
  fd_ = open(file.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0600);
  if (fd_ < 0) {
    throw CannotListen(fmt::format("cannot listen on {}: {} can't be made: {}", endpoint, file,
                                   std::strerror(errno)));
  }
  if (flock(fd_, LOCK_EX | LOCK_NB) != 0) {
    close(fd_);
    throw CannotListen(fmt::format(
        "{} is in use: another server runs there; stop it, or listen on another path", endpoint));
  }
}

EndpointLock::~EndpointLock() {
  if (fd_ >= 0) close(fd_);
}

}  // namespace graspd::service
