#pragma once

#include <cstddef>

#ifdef __SANITIZE_THREAD__
#include <atomic>
#include <thread>
#include <vector>
#else
#include <tbb/parallel_for.h>
#include <tbb/parallel_invoke.h>
#include <tbb/task_arena.h>
#endif

namespace graspd::perception {

/// How many threads may call bodies at once.
inline std::size_t threads_n() {
#ifdef __SANITIZE_THREAD__
  return 4;
#else
  return static_cast<std::size_t>(tbb::this_task_arena::max_concurrency());
#endif
}

/// Calls body(i) for every i below `count`, in parallel within the caller's TBB arena.
template <class Body>
void parallel_for(std::size_t count, const Body& body) {
#ifdef __SANITIZE_THREAD__
  // Debian's TBB is built without ThreadSanitizer, which would take every hand-over of work for a
  // race. Plain threads run the same bodies, so that races between these are still found.
  std::atomic<std::size_t> next = 0;
  std::vector<std::jthread> threads;
  for (std::size_t t = 0; t < threads_n(); ++t) {
    threads.emplace_back([&] {
      for (std::size_t i = next++; i < count; i = next++) body(i);
    });
  }
#else
  tbb::parallel_for(std::size_t{0}, count, body);
#endif
}

/// Calls both, in parallel within the caller's TBB arena.
template <class One, class Other>
void parallel_invoke(const One& one, const Other& other) {
#ifdef __SANITIZE_THREAD__
  const std::jthread thread(other);
  one();
#else
  tbb::parallel_invoke(one, other);
#endif
}

}  // namespace graspd::perception
