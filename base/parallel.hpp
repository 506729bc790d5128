// Independent jobs on a few threads, and on other ranks where there are any.
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

/// As many threads as asked for; 0 is as many as the machine has.
[[nodiscard]] inline int thread_count(int asked) {
  return asked > 0 ? asked : std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
}

/// Adds `n` threads that do `work` to a crew, or as many as the system grants: where a limit of
/// processes is reached (a container's, a batch system's), fewer do the same.
template <typename Work>
void enlist(std::vector<std::jthread>& crew, int n, const Work& work) {
  try {
    for (int t = 0; t < n; ++t) crew.emplace_back(work);
  } catch (const std::system_error&) {
    return;
  } catch (const std::bad_alloc&) {  // of a thread's own state, or its stack
    return;
  }
}

/// Calls job(0), …, job(n - 1), each once, on up to `threads` threads; rethrows the first exception
/// of the lowest-numbered job that failed.
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

/// The same where each job's outcome can be carried: the jobs are shared out among the ranks, if
/// there are others and this is not a part of another parallel_for.
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

/// Whether the run is to stop, as far as this thread may know: where ranks must take the same turn,
/// what they have agreed on; within a unit that is shared out, what any of them wishes; and, alone,
/// `wish`.
[[nodiscard]] inline bool is_to_stop(bool wish) {
  const Ranks* all = ranks();
  if (all == nullptr) return wish;
  return within().shared ? wish || all->told_to_stop() : all->stop_agreed();
}

}  // namespace wheeltap::base
