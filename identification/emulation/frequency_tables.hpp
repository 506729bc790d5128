// Tables of a damaged beam's frequencies, one per number of damages, and their files.
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

/// Hash value that identifies a beam by its geometry, mesh, supports, material and section.
[[nodiscard]] std::string beam_fingerprint(const fem::Beam& beam);

/// Name of the table for `count` damages within a file, for example "count_1".
[[nodiscard]] std::string table_name(int count);

/// The stored training data of an emulator. Table factors: location_1 [m], reduction_1, location_2
/// …. Responses: elastic frequencies [Hz]. Attribute "interpolation": name of the interpolant.
struct FrequencyTables {
  std::vector<emulator::Table> tables;  ///< table i is for i + 1 damages
  /// Entry i is for i + 1 damages. With ANOVA, also for numbers of damages without a table.
  std::vector<EmulatorError> errors;
  bool symmetrised = false;  ///< predictions are means over damages and their mirror images
  /// The case of more than two damages: the function of the frequency whose changes are added. If
  /// `anova` is set, the table for two damages also contains the intact frequencies.
  std::optional<emulator::Additive> anova;
};

/// Reads the tables for up to `max_count` damages from a file that was computed for this beam.
/// Throws io::FileError; throws std::invalid_argument if the file has too few tables or modes.
[[nodiscard]] FrequencyTables read_frequency_tables(const std::filesystem::path& path,
                                                    const fem::Beam& beam, int max_count,
                                                    int modes);

/// Writes a table file with the standard attributes and the additional `attributes`. Throws the
/// exceptions of emulator::write_table_file.
void write_frequency_tables(const std::filesystem::path& path, const fem::Beam& beam,
                            FrequencyTables tables, std::map<std::string, std::string> attributes);

/// Intact frequencies [Hz] that a table for ANOVA contains.
[[nodiscard]] std::vector<double> intact_frequencies(const emulator::Table& pair);
void keep_intact_frequencies(emulator::Table& pair, std::span<const double> frequencies_hz);

}  // namespace wheeltap::identification
