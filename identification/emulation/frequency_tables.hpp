// Tables of a damaged beam's frequencies, one a damage count, and the files that keep them.
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "emulator/anova.hpp"
#include "emulator/table_file.hpp"
#include "fem/beam/beam.hpp"
#include "identification/emulation/emulator_error.hpp"

namespace wheeltap::identification {

/// What identifies a beam to its tables: geometry, mesh, supports, material and section as numbers.
[[nodiscard]] std::string beam_fingerprint(const fem::Beam& beam);

/// The name of the table for `count` damages within a file: "count_1".
[[nodiscard]] std::string table_name(int count);

/// All that an emulator keeps of its training. The factors of a table are location_1 [m],
/// reduction_1, location_2 …; its responses are elastic frequencies [Hz], its attribute
/// "interpolation" names the interpolant.
struct FrequencyTables {
  std::vector<emulator::Table> tables;  ///< entry i for i + 1 damages
  std::vector<EmulatorError> errors;    ///< entry i for i + 1 damages; with ANOVA beyond the tables
  bool symmetrised = false;             ///< answers are means over damages and their mirror images
  /// In which counts beyond two are summed; the table for two then has the intact frequencies.
  std::optional<emulator::Additive> anova;
};

/// Reads a table file made for this beam, up to `max_count` damages. Throws io::FileError, and
/// std::invalid_argument where it holds too few counts or modes.
[[nodiscard]] FrequencyTables read_frequency_tables(const std::filesystem::path& path,
                                                    const fem::Beam& beam, int max_count,
                                                    int modes);

/// Writes such a file; `attributes` are added to its own. Throws as emulator::write_table_file.
void write_frequency_tables(const std::filesystem::path& path, const fem::Beam& beam,
                            FrequencyTables tables, std::map<std::string, std::string> attributes);

/// The intact frequencies [Hz] that a table with ANOVA keeps, and where it does.
[[nodiscard]] std::vector<double> intact_frequencies(const emulator::Table& pair);
void keep_intact_frequencies(emulator::Table& pair, std::span<const double> frequencies_hz);

}  // namespace wheeltap::identification
