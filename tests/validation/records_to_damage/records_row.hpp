// What the program's commands made of one frame's records, beside its truth: a line of a file.
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "frame_case.hpp"

namespace wheeltap::coverage {

struct RecordsRow {
  int number = 0;
  std::string name = {};
  bool is_damaged = false;
  double reduction = 0.0;
  double largest_shift = 0.0;  ///< of a true frequency in the band by the damage, relative
  int modes = 0;               ///< healthy and damaged, that the case took
  int in_band = 0;             ///< true ones
  double probability = 0.0;    ///< of damage
  double fit_p = 0.0;
  bool converged = false;
  /// P(draw < truth) + U P(draw = truth), U uniform: of "E posts", "E girders" and "reduction" (0
  /// where there is none) over all draws; of "place" (on the line of all members) and "reduction if
  /// any" over the draws with damage, where the truth has one and most draws have.
  std::map<std::string, double> ranks = {};
  double seconds_modal = 0.0, seconds_damage = 0.0;

  [[nodiscard]] std::string to_line() const;  ///< JSON
  [[nodiscard]] static RecordsRow from_line(
      const std::string& line);  ///< throws what the parser does
};

struct RecordsOptions {
  std::string program;           ///< wheeltap
  std::filesystem::path folder;  ///< of the case's files
  double noise = 0.05;           ///< of the sensors
  std::uint64_t seed = 1;        ///< of the study
  std::string sampling = {};     ///< options of `wheeltap damage`
  bool keep_records = false;
};

/// Writes records and cases, runs `modal` on both records and `damage` on what they gave. Throws
/// std::runtime_error where a command fails.
[[nodiscard]] RecordsRow run_records(const FrameCase& c, const RecordsOptions& options);

/// Tables: coverage of each quantity, P(damage) against the truth, and the detection limit.
[[nodiscard]] std::string records_report(const std::vector<RecordsRow>& rows);

}  // namespace wheeltap::coverage
