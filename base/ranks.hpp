// Several processes (ranks) that run the same program on the same input and share its work.
//
// Every rank executes the whole program: all cheap work, and its part of expensive work
// (base::parallel_for with a Carriage), after which all ranks have all outcomes. Each rank thus
// always has the complete state, no other communication is needed, and rank 0 writes the files.
// Information that only one rank has (a clock, a signal, a result file) must be distributed by the
// functions here, so that all ranks take the same branch.
#pragma once

#include <atomic>
#include <functional>
#include <string>
#include <string_view>
#include <utility>

namespace wheeltap::base {

/// Transfers the outcome of a unit of work to the ranks that did not compute it.
struct Carriage {
  /// Called by the thread that computed the unit, right after it.
  std::function<std::string(int unit)> pack;
  /// Called by the thread that requested all units.
  std::function<void(int unit, std::string_view bytes)> unpack;
  /// Called by rank 0 during shared work: whether all ranks should pause (Ranks::pause_requested).
  std::function<bool()> pause = {};
};

/// One process of several. Every rank must call all non-const members in the same order, from the
/// thread that joined.
class Ranks {
 public:
  Ranks() = default;
  Ranks(const Ranks&) = delete;
  Ranks& operator=(const Ranks&) = delete;
  virtual ~Ranks() = default;

  [[nodiscard]] virtual int rank() const = 0;
  [[nodiscard]] virtual int size() const = 0;

  /// Calls job(0), …, job(n - 1), each once, on some rank, by up to `threads` threads on each; the
  /// next unit goes to the next free thread. All ranks throw the exception of the lowest-numbered
  /// failed unit, and repeat that unit if it failed on another rank.
  virtual void share_out(int n, int threads, const std::function<void(int)>& job,
                         const Carriage& carriage) = 0;
  /// The bytes of rank 0, on every rank.
  [[nodiscard]] virtual std::string from_first(std::string bytes) = 0;
  /// Whether all ranks have the same bytes.
  [[nodiscard]] virtual bool all_have(const std::string& bytes) = 0;
  /// Waits until all ranks have called this, at most `seconds`; false on timeout.
  [[nodiscard]] virtual bool meet(double seconds) = 0;
  /// Terminates all ranks at once.
  [[noreturn]] virtual void abort(int exit_code) = 0;

  /// Sets a callback for requests to stop, called during shared work. A request of any rank becomes
  /// the decision of all at the end of that work.
  void on_wish_to_stop(std::function<bool()> wish) { wish_ = std::move(wish); }
  /// Requests a stop. Safe to call from any thread.
  void ask_to_stop() { asked_ = true; }
  [[nodiscard]] virtual bool stop_agreed() const = 0;
  /// During shared work: whether some rank has requested to stop; whether rank 0 has requested to
  /// pause.
  [[nodiscard]] virtual bool stop_requested() const = 0;
  [[nodiscard]] virtual bool pause_requested() const = 0;

 protected:
  [[nodiscard]] bool wishes_to_stop() const { return asked_ || (wish_ && wish_()); }

 private:
  std::function<bool()> wish_;
  std::atomic<bool> asked_{false};
};

/// The ranks of this process; null if it is the only one.
[[nodiscard]] inline Ranks*& ranks() {
  static Ranks* all = nullptr;
  return all;
}

/// Whether this process writes the results: it is the only one, or rank 0.
[[nodiscard]] inline bool is_first_rank() {
  return ranks() == nullptr || ranks()->rank() == 0;
}

/// Current context of this thread.
struct Within {
  bool job = false;     ///< inside a job of any parallel_for: nested ones stay on this rank
  bool shared = false;  ///< inside a shared unit: other ranks execute different units
};
[[nodiscard]] inline Within& within() {
  static thread_local Within at;
  return at;
}

/// Marks this thread during the lifetime of the object.
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
