#pragma once

#include <cstdint>

/// Counts what is taken from the heap. Whatever links this has its own malloc, calloc, realloc and
/// aligned relatives before glibc's: `new`, OpenCV's and Highway's memory are all counted. For
/// benchmarks only, and not under a sanitizer.
namespace graspd::bench {

struct AllocationCount {
  std::int64_t calls_n = 0;
  std::int64_t bytes = 0;

  AllocationCount operator-(const AllocationCount& other) const {
    return {calls_n - other.calls_n, bytes - other.bytes};
  }
};

/// Of all threads since the program began.
AllocationCount allocations();

}  // namespace graspd::bench
