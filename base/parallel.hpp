// Independent jobs on a few threads.
#pragma once

#include <algorithm>
#include <atomic>
#include <exception>
#include <mutex>
#include <thread>
#include <vector>

namespace wheeltap::base {

/// As many threads as asked for; 0 is as many as the machine has.
[[nodiscard]] inline int thread_count(int asked) {
  return asked > 0 ? asked : std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
}

/// Calls job(0), …, job(n - 1), each once, on up to `threads` threads; rethrows the first exception
/// of the lowest-numbered job that failed.
template <typename Job>
void parallel_for(int n, int threads, Job&& job) {
  std::vector<std::exception_ptr> errors(static_cast<std::size_t>(n));
  std::atomic<int> next{0};
  const auto work = [&] {
    for (int i = next++; i < n; i = next++) {
      try {
        job(i);
      } catch (...) {
        errors[static_cast<std::size_t>(i)] = std::current_exception();
      }
    }
  };
  const int extra = std::min(thread_count(threads), n) - 1;
  std::vector<std::jthread> pool;
  for (int t = 0; t < extra; ++t) pool.emplace_back(work);
  work();
  pool.clear();
  for (const std::exception_ptr& error : errors) {
    if (error) std::rethrow_exception(error);
  }
}

}  // namespace wheeltap::base
