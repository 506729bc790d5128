// Execution of the program as one of several MPI ranks (base/ranks.hpp).
#pragma once

#include <exception>
#include <optional>
#include <string>

#include "apps/failure.hpp"
#include "base/ranks.hpp"

namespace wheeltap::apps {

/// Thrown on ranks other than 0 if rank 0 fails in work that it does for all ranks. Rank 0 reports
/// the error.
class FailedOnFirstRank : public std::exception {};

/// Joins the other ranks through the MPI module if mpirun (or srun with PMIx) started this process.
/// In a process without other ranks, the class has no effect. Ranks other than the first print
/// nothing on standard output and error, and use one thread each by default.
class JoinedRanks {
 public:
  /// Throws Failure (64) if there are other ranks and the MPI module is missing.
  JoinedRanks();
  JoinedRanks(const JoinedRanks&) = delete;
  JoinedRanks& operator=(const JoinedRanks&) = delete;
  ~JoinedRanks();

  /// Ends the work of this rank. If only this rank failed, the function ends the other ranks, which
  /// would otherwise wait, and prints `last_words` on the original standard error.
  void leave(int exit_code, const std::string& last_words);

 private:
  base::Ranks* all_ = nullptr;
  int said_ = -1;  // descriptor of the original standard error
};

/// Throws Failure (65) if `text` differs between ranks (e.g. a case that each rank read on its own
/// machine): "the ranks do not have the same WHAT".
void require_same_on_all_ranks(const std::string& what, const std::string& text);

/// Throws Failure (64) if ranks run on different processors without --simd baseline, because the
/// results of library functions may then differ in the last bit.
void require_equal_processors();

/// Calls f on rank 0 only and returns its result on all ranks. If f throws on rank 0, the other
/// ranks throw FailedOnFirstRank.
template <class F>
[[nodiscard]] std::optional<std::string> first_rank_says(F&& f) {
  base::Ranks* all = base::ranks();
  if (all == nullptr) return f();
  constexpr char kFailed = 'f', kNothing = 'n', kText = 't';
  std::string bytes;
  std::exception_ptr error;
  if (all->rank() == 0) {
    try {
      const std::optional<std::string> said = f();
      bytes = said ? kText + *said : std::string(1, kNothing);
    } catch (...) {
      error = std::current_exception();
      bytes = kFailed;
    }
  }
  bytes = all->from_first(std::move(bytes));
  if (error) std::rethrow_exception(error);
  if (bytes.front() == kFailed) throw FailedOnFirstRank();
  if (bytes.front() == kNothing) return {};
  return bytes.substr(1);
}

/// Calls f on rank 0 only.
template <class F>
void on_first_rank(F&& f) {
  static_cast<void>(first_rank_says([&]() -> std::optional<std::string> {
    f();
    return {};
  }));
}

}  // namespace wheeltap::apps
