// Several processes that run the same program on the same input, and share its work.
//
// Every rank goes the same way through the program: it does by itself what is cheap, and a part of
// what is dear (base::parallel_for with a Carriage), after which all ranks have all outcomes. So
// each has the whole state at any time, nothing else needs to be sent, and rank 0 writes the files.
// What only one rank can know (a clock, a signal, a file of results) must be asked for here, so
// that all take the same turn.
#pragma once

#include <atomic>
#include <functional>
#include <string>
#include <string_view>
#include <utility>

namespace wheeltap::base {

/// How the outcome of a unit of work gets to the ranks that have not done it.
struct Carriage {
  std::function<std::string(int unit)> pack;  ///< called by the thread that did it, right after
  std::function<void(int unit, std::string_view bytes)> unpack;  ///< by the one that asked for all
  /// Asked by rank 0 while units are on their way: whether all are to leave their work
  /// (Ranks::told_to_pause).
  std::function<bool()> pause = {};
};

/// One process of several. All members but the const ones are to be called by every rank, in the
/// same order, by the thread that joined.
class Ranks {
 public:
  Ranks() = default;
  Ranks(const Ranks&) = delete;
  Ranks& operator=(const Ranks&) = delete;
  virtual ~Ranks() = default;

  [[nodiscard]] virtual int rank() const = 0;
  [[nodiscard]] virtual int size() const = 0;

  /// Calls job(0), …, job(n - 1), each once, on some rank, by up to `threads` threads on each: the
  /// next unit goes to whoever is free. Throws everywhere what the lowest-numbered unit that failed
  /// threw; where it failed elsewhere, by doing it again.
  virtual void share_out(int n, int threads, const std::function<void(int)>& job,
                         const Carriage& carriage) = 0;
  /// The bytes of rank 0, on every rank.
  [[nodiscard]] virtual std::string from_first(std::string bytes) = 0;
  /// Whether all ranks have the same bytes.
  [[nodiscard]] virtual bool all_have(const std::string& bytes) = 0;
  /// Waits until all ranks have come here, at most so long; false: some have not.
  [[nodiscard]] virtual bool meet(double seconds) = 0;
  /// Ends all ranks, wherever they are.
  [[noreturn]] virtual void abort(int exit_code) = 0;

  /// Any rank's wish that the run may stop, for whatever reason: `wish` is asked while work is
  /// shared out. All agree on it at the end of that.
  void on_wish_to_stop(std::function<bool()> wish) { wish_ = std::move(wish); }
  /// Any thread may.
  void ask_to_stop() { asked_ = true; }
  [[nodiscard]] virtual bool stop_agreed() const = 0;
  /// For units on their way: some rank wishes to stop; rank 0 wishes them to pause.
  [[nodiscard]] virtual bool told_to_stop() const = 0;
  [[nodiscard]] virtual bool told_to_pause() const = 0;

 protected:
  [[nodiscard]] bool wishes_to_stop() const { return asked_ || (wish_ && wish_()); }

 private:
  std::function<bool()> wish_;
  std::atomic<bool> asked_{false};
};

/// What this process is one of; null where it is alone.
[[nodiscard]] inline Ranks*& ranks() {
  static Ranks* all = nullptr;
  return all;
}

/// Whether this process writes what is found: it is alone, or rank 0.
[[nodiscard]] inline bool is_first_rank() {
  return ranks() == nullptr || ranks()->rank() == 0;
}

/// What this thread is at.
struct Within {
  bool job = false;     ///< of any parallel_for: those within it stay on this thread's rank
  bool shared = false;  ///< of one whose units are shared out: other ranks are elsewhere
};
[[nodiscard]] inline Within& within() {
  static thread_local Within at;
  return at;
}

/// Marks this thread for as long as it lives.
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
