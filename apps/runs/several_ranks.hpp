// The program as one of several ranks that mpirun has started (base/ranks.hpp).
#pragma once

#include <exception>
#include <optional>
#include <string>

#include "apps/failure.hpp"
#include "base/ranks.hpp"

namespace wheeltap::apps {

/// Rank 0 could not do what it does for all, and says so itself.
class FailedOnFirstRank : public std::exception {};

/// Joins the others where mpirun (or srun with PMIx) has started this process, by the module that
/// speaks MPI; else does nothing. Ranks but the first say nothing on standard output and error, and
/// have each one thread unless --threads says otherwise.
class JoinedRanks {
 public:
  /// Throws Failure (64) where there are others and the module is missing.
  JoinedRanks();
  JoinedRanks(const JoinedRanks&) = delete;
  JoinedRanks& operator=(const JoinedRanks&) = delete;
  ~JoinedRanks();

  /// The end of this rank's work. One that failed alone ends the others, which would wait for it;
  /// `last_words` then are said on the error stream that all had.
  void leave(int exit_code, const std::string& last_words);

 private:
  base::Ranks* all_ = nullptr;
  int said_ = -1;  // standard error as it was
};

/// Throws Failure (65) where the ranks do not all have this, e.g. the text of a case that each has
/// read on its own machine: "the ranks have not the same WHAT".
void require_same_on_all_ranks(const std::string& what, const std::string& text);

/// Throws Failure (64) where ranks run on unlike processors, whose library functions differ in the
/// last bit, and have not been told to keep to what all have (--simd baseline).
void require_equal_processors();

/// What f returns on rank 0, which alone calls it, on all. Throws FailedOnFirstRank on the others
/// where it throws there.
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

/// f() on rank 0 alone.
template <class F>
void on_first_rank(F&& f) {
  static_cast<void>(first_rank_says([&]() -> std::optional<std::string> {
    f();
    return {};
  }));
}

}  // namespace wheeltap::apps
