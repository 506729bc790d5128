// Results of the program's commands for one frame's records, and its truth: one line of a file.
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
  double largest_shift = 0.0;  ///< largest relative change of a true frequency in the band
  int modes = 0;               ///< modes in the case, healthy and damaged
  int in_band = 0;             ///< true modes in the band
  double probability = 0.0;    ///< P(at least one damage)
  double fit_p = 0.0;
  bool converged = false;
  /// P(draw < truth) + U P(draw = truth), U uniform. Over all draws: "E posts", "E girders" and
  /// "reduction" (0 without damage). Over the draws with damage, if the truth and most draws have
  /// one: "place" (on the line of all members) and "reduction if any".
  std::map<std::string, double> ranks = {};
  double seconds_modal = 0.0, seconds_damage = 0.0;

  [[nodiscard]] std::string to_line() const;  ///< JSON
  [[nodiscard]] static RecordsRow from_line(
      const std::string& line);  ///< throws as the parser does
};

struct RecordsOptions {
  std::string program;           ///< wheeltap
  std::filesystem::path folder;  ///< folder of the case's files
  double noise = 0.05;           ///< sensor noise / standard deviation of the channel
  std::uint64_t seed = 1;        ///< seed of the study
  std::string sampling = {};     ///< options of `wheeltap damage`
  bool keep_records = false;
};

/// Writes records and cases, runs `modal` on both records and `damage` on the identified modes.
/// Throws std::runtime_error if a command fails.
[[nodiscard]] RecordsRow run_records(const FrameCase& c, const RecordsOptions& options);

/// Tables: coverage of each quantity, P(damage) against the truth, and the detection limit.
[[nodiscard]] std::string records_report(const std::vector<RecordsRow>& rows);

}  // namespace wheeltap::coverage
