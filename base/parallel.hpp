// Parallel execution of independent jobs on several threads and, in a run with several ranks, on
// all ranks.
#pragma once

#include <algorithm>
#include <atomic>
#include <exception>
#include <new>
#include <system_error>
#include <thread>
#include <vector>

#include "base/ranks.hpp"

namespace wheeltap::base {

/// Returns the number of threads to use: the requested number, or the number of processors if the
/// requested number is 0.
[[nodiscard]] inline int thread_count(int asked) {
  return asked > 0 ? asked : std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
}

/// Starts up to `n` threads that run `work`. If the system allows fewer threads (container, batch
/// system), this function starts fewer threads. The started threads then do all of the work.
template <typename Work>
void enlist(std::vector<std::jthread>& crew, int n, const Work& work) {
  try {
    for (int t = 0; t < n; ++t) crew.emplace_back(work);
  } catch (const std::system_error&) {
    return;
  } catch (const std::bad_alloc&) {  // no memory for the thread's state or stack
    return;
  }
}

/// Calls job(0), …, job(n - 1), each once, on up to `threads` threads. If jobs fail, this function
/// rethrows the exception of the failed job with the lowest index.
template <typename Job>
void parallel_for(int n, int threads, Job&& job) {
  std::vector<std::exception_ptr> errors(static_cast<std::size_t>(n));
  std::atomic<int> next{0};
  const bool shared = within().shared;
  const auto work = [&] {
    const Inside marked({.job = true, .shared = shared});
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
  enlist(pool, extra, work);
  work();
  pool.clear();
  for (const std::exception_ptr& error : errors) {
    if (error) std::rethrow_exception(error);
  }
}

/// Calls job(0), …, job(n - 1) for jobs whose results can be transferred between ranks. The jobs
/// are distributed over all ranks, except if this call is inside another parallel_for.
template <typename Job>
void parallel_for(int n, int threads, Job&& job, const Carriage& carriage) {
  if (ranks() == nullptr || within().job) return parallel_for(n, threads, job);
  ranks()->share_out(
      n, threads,
      [&](int i) {
        const Inside marked({.job = true, .shared = true});
        job(i);
      },
      carriage);
}

/// Returns true if the run must stop. In a run with one process, the result is `wish`. In a run
/// with several ranks, all ranks get the same result. Inside a shared job, the result is true if
/// `wish` is true or any rank has requested a stop.
[[nodiscard]] inline bool is_to_stop(bool wish) {
  const Ranks* all = ranks();
  if (all == nullptr) return wish;
  return within().shared ? wish || all->stop_requested() : all->stop_agreed();
}

}  // namespace wheeltap::base
