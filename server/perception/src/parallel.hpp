#pragma once

#include <cstddef>

#ifdef __SANITIZE_THREAD__
#include <atomic>
#include <thread>
#include <vector>
#else
#include <tbb/parallel_for.h>
#endif

namespace graspd::perception {

/// Calls body(i) for every i below `count`, in parallel within the caller's TBB arena.
template <class Body>
void parallel_for(std::size_t count, const Body& body) {
#ifdef __SANITIZE_THREAD__
  // Debian's TBB is built without ThreadSanitizer, which would take every hand-over of work for a
  // race. Plain threads run the same bodies, so that races between these are still found.
  std::atomic<std::size_t> next = 0;
  std::vector<std::jthread> threads;
  for (int t = 0; t < 4; ++t) {
    threads.emplace_back([&] {
      for (std::size_t i = next++; i < count; i = next++) body(i);
    });
  }
#else
  tbb::parallel_for(std::size_t{0}, count, body);
#endif
}

}  // namespace graspd::perception
