#pragma once

#include <sys/types.h>

#include <cstdint>

namespace graspd::service {

/// Resident memory of a process; 0 where it has ended.
std::uint64_t resident_bytes(pid_t pid);

}  // namespace graspd::service
