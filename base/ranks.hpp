// Several processes (ranks) that run the same program on the same input and share its work.
//
// Every rank executes the whole program. Each rank does all cheap work and a part of the expensive
// jobs (base::parallel_for with a Carriage). Then the ranks exchange the results of these jobs.
// Each rank therefore always has the complete state and needs no other communication. Rank 0 writes
// the files. A function of this header must distribute information that only one rank has (a clock,
// a signal, a result file). Otherwise, the ranks might take different branches.
#pragma once

#include <atomic>
#include <functional>
#include <string>
#include <string_view>
#include <utility>

namespace wheeltap::base {

/// Transfers the result of a job to the ranks that did not compute it.
struct Carriage {
  /// Packs the result of a job. The thread that ran the job calls this function directly after the
  /// job.
  std::function<std::string(int unit)> pack;
  /// Unpacks the result of a job. The thread that started the parallel loop calls this function.
  std::function<void(int unit, std::string_view bytes)> unpack;
  /// Returns true if all ranks should pause (Ranks::pause_requested). Rank 0 calls this function
  /// during shared work.
  std::function<bool()> pause = {};
};

/// One of several processes of a run. Every rank must call all non-const members in the same order,
/// and from the thread that created this object.
class Ranks {
 public:
  Ranks() = default;
  Ranks(const Ranks&) = delete;
  Ranks& operator=(const Ranks&) = delete;
  virtual ~Ranks() = default;

  [[nodiscard]] virtual int rank() const = 0;
  [[nodiscard]] virtual int size() const = 0;

  /// Calls job(0), …, job(n - 1), each once on one of the ranks, with up to `threads` threads per
  /// rank. The next free thread takes the next job. If jobs fail, all ranks throw the exception of
  /// the failed job with the lowest index. Ranks that did not run the failed job repeat this job to
  /// obtain its exception.
  virtual void share_out(int n, int threads, const std::function<void(int)>& job,
                         const Carriage& carriage) = 0;
  /// Distributes the bytes of rank 0 to all ranks. On every rank, this function returns the bytes
  /// of rank 0.
  [[nodiscard]] virtual std::string from_first(std::string bytes) = 0;
  /// Returns true if all ranks call this function with identical bytes.
  [[nodiscard]] virtual bool all_have(const std::string& bytes) = 0;
  /// Waits until all ranks have called this function. Returns false if a rank has not called
  /// this function within `seconds`.
  [[nodiscard]] virtual bool meet(double seconds) = 0;
  /// Terminates all ranks at once.
  [[noreturn]] virtual void abort(int exit_code) = 0;

  /// Sets a callback that returns true to request a stop. The ranks call the callback during shared
  /// work. If any rank requests a stop, all ranks decide to stop at the end of the shared work.
  void on_wish_to_stop(std::function<bool()> wish) { wish_ = std::move(wish); }
  /// Requests a stop of the run. Any thread may call this function.
  void ask_to_stop() { asked_ = true; }
  [[nodiscard]] virtual bool stop_agreed() const = 0;
  /// stop_requested() is true during shared work if some rank has requested a stop.
  /// pause_requested() is true during shared work if rank 0 has requested a pause.
  [[nodiscard]] virtual bool stop_requested() const = 0;
  [[nodiscard]] virtual bool pause_requested() const = 0;

 protected:
  [[nodiscard]] bool wishes_to_stop() const { return asked_ || (wish_ && wish_()); }

 private:
  std::function<bool()> wish_;
  std::atomic<bool> asked_{false};
};

/// The ranks of the run to which this process belongs; null if the run has only one process.
[[nodiscard]] inline Ranks*& ranks() {
  static Ranks* all = nullptr;
  return all;
}

/// True if this process writes the results, because it is rank 0 or the only process of the run.
[[nodiscard]] inline bool is_first_rank() {
  return ranks() == nullptr || ranks()->rank() == 0;
}

/// Parallel loops that this thread is currently executing.
struct Within {
  bool job = false;     ///< inside a job of a parallel_for; a nested loop runs on this rank only
  bool shared = false;  ///< inside a job shared by the ranks; other ranks execute other jobs
};
[[nodiscard]] inline Within& within() {
  static thread_local Within at;
  return at;
}

/// Marks this thread as inside a parallel loop during the lifetime of the object.
class Inside {
 public:
  explicit Inside(Within at) : before_(std::exchange(within(), at)) {}
  Inside(const Inside&) = delete;
  Inside& operator=(const Inside&) = delete;
  ~Inside() { within() = before_; }

 private:
  Within before_;
};

}  // namespace wheeltap::base
