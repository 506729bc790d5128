// Calibration of the rows of a coverage study, as tables.
#pragma once

#include <string>
#include <vector>

#include "coverage_row.hpp"

namespace wheeltap::coverage {

/// A cell of a reliability table, for all stated probabilities in [low, high): their number, their
/// sum, and the number of true events.
struct Reliability {
  double low, high;
  int stated = 0;
  double expected = 0.0, variance = 0.0;  ///< Σ P, Σ P (1 - P)
  int truths = 0;
  /// Two-sided tail of the number of truths by the normal law, continuity corrected; 1 if
  /// nothing is uncertain.
  [[nodiscard]] double p_value() const;
};
/// Reliability of every combination of counts, or (`totals`) of the total number of defects.
[[nodiscard]] std::vector<Reliability> reliability(const std::vector<Row>& rows, bool totals);

/// Coverage by the ranks of one function.
struct Coverage {
  std::string function;
  int ranks = 0;
  int held = 0;         ///< in [0.05, 0.95]: by the central 90 % interval
  double lowest = 0.0;  ///< 95 % interval of the share held (Clopper & Pearson 1934)
  double highest = 1.0;
  double uniform_p = 1.0;  ///< χ² of equal bins with 5 expected or more, at most 10
};
[[nodiscard]] Coverage coverage(std::string function, const std::vector<double>& ranks);
/// Coverage of every function that the rows have; those within the true model first.
[[nodiscard]] std::vector<Coverage> coverages(const std::vector<Row>& rows);

/// A case with a wrong answer: the true combination of counts has P < 0.01, or a rank lies outside
/// the 99.9 % interval, or the truth is more likely than every draw by 3 or more.
struct Surprise {
  const Row* row;
  std::vector<std::string> what;
};
[[nodiscard]] std::vector<Surprise> surprises(const std::vector<Row>& rows);
/// Expected numbers of cases with P(truth) < 0.01 and of ranks outside 99.9 % under calibration.
struct Expected {
  double improbable_truths, extreme_ranks;
};
[[nodiscard]] Expected expected_surprises(const std::vector<Row>& rows);

/// Faults with a probability below 1 in 10 000 by chance: in the coverage or uniformity of a
/// function or in the reliability, or a truth far from all draws of a run without any warning.
[[nodiscard]] std::vector<std::string> faults(const std::vector<Row>& rows);

/// All tables as Markdown.
[[nodiscard]] std::string report(const std::vector<Row>& rows);

}  // namespace wheeltap::coverage
