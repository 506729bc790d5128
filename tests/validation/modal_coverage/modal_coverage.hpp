// Coverage of the credible intervals of identified modes: many records of one structure with known
// modes, each identified separately.
#pragma once

#include <cstdint>
#include <iosfwd>
#include <string>
#include <vector>

#include "../../signals/random_vibration.hpp"

namespace wheeltap::signals {

struct CoverageCase {
  std::string name;
  VibratingStructure structure;
  double seconds = 900.0;
  double noise = 0.05;  ///< sensor noise / standard deviation of the channel
  double lowest_hz = 0.0, highest_hz = 0.0;
  int largest_order = 0, blocks = 0;
};

/// "chain": three masses of 1 kg, 200 N/m, 1.5 %, 0.05 s. "close": two modes 2 % apart, as wide as
/// that, and a third. "frame": eight storeys with one sensor each. Throws std::invalid_argument for
/// other names.
[[nodiscard]] CoverageCase coverage_case(const std::string& name);

/// Coverage of one quantity over all records.
struct CoverageRow {
  std::string name;
  double truth = 0.0;
  int found = 0;             ///< records that have the mode
  double covered = 0.0;      ///< share of 95 % intervals that contain the truth
  double bias = 0.0;         ///< mean - truth, in empirical standard deviations
  double predicted = 0.0;    ///< root mean square of predicted over empirical standard deviation
  double typical = 0.0;      ///< median of predicted over empirical standard deviation
  double against_law = 0.0;  ///< empirical standard deviation over Au's long-data law; 0: none
};

struct Coverage {
  std::vector<CoverageRow> rows;  ///< f and ζ of each mode, then each mode's shape
  int records = 0;
  double covered = 0.0, predicted = 0.0;  ///< over all f and ζ
  double surplus = 0.0;                   ///< spurious modes per record
  double doubted = 0.0;  ///< share of the spurious modes that is marked as doubtful
};

[[nodiscard]] Coverage modal_coverage(const CoverageCase& of, int records, std::uint64_t seed,
                                      int threads = 0);
void print(std::ostream& out, const Coverage& coverage);

}  // namespace wheeltap::signals
