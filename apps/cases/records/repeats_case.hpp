// Frequencies of repeated tests in a case: "repeats" in a block of data.
#pragma once

#include <string>

#include "apps/cases/syntax/case_file.hpp"
#include "identification/structural/repeated_tests.hpp"

namespace wheeltap::apps {

/// Parses "repeats" in the block of data at `where` (e.g. /data) and infers the mean frequencies
/// and the scatter between the tests. Throws Failure (65) for keys that contradict "repeats", for
/// rows of unequal length, for too few tests and, with `ascending`, for mean frequencies that do
/// not increase.
[[nodiscard]] identification::RepeatedTests parse_repeats(const CaseFile& file,
                                                          const Pointer& where, bool ascending);

/// Describes repeated tests in one line: "34 repeated tests of tests.csv; scatter between tests
/// 0.16 to 0.45 %; probable outliers: tests 33 and 34". `origin` is "given in the case" or "from
/// tests.csv".
[[nodiscard]] std::string in_words(const identification::RepeatedTests& tests,
                                   const std::string& origin);

}  // namespace wheeltap::apps
