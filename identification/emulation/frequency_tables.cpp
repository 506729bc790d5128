#include "identification/emulation/frequency_tables.hpp"

#include <algorithm>
#include <stdexcept>

#include "io/fingerprint.hpp"
#include "io/json_number.hpp"

namespace wheeltap::identification {
namespace {

using Eigen::Index;
using emulator::RowMatrix;
using emulator::Table;

RowMatrix row(std::span<const double> values) {
  RowMatrix out(1, static_cast<Index>(values.size()));
  std::ranges::copy(values, out.data());
  return out;
}

std::vector<double> vector_of(const RowMatrix& matrix) {
  return {matrix.data(), matrix.data() + matrix.size()};
}

std::string error_name(int count) {
  return "error_" + table_name(count);
}

// The emulator error stored in a table.
EmulatorError error_of(const Table& table, int count, const std::filesystem::path& path) {
  EmulatorError error;
  if (const auto e = table.parameters.find(error_name(count)); e != table.parameters.end()) {
    error = error_from(e->second);
  } else {
    error.holdout = table.holdout;
  }
  if (const auto l = table.parameters.find("leave_one_out"); l != table.parameters.end()) {
    error.leave_one_out = vector_of(l->second);
  }
  if (error.holdout.empty()) {
    throw io::FileError(io::FileError::Kind::foreign, path,
                        "has no holdout errors of its emulator");
  }
  return error;
}

}  // namespace

// The keys are in alphabetical order, as in JSON. Another format would invalidate older tables.
std::string beam_fingerprint(const fem::Beam& beam) {
  const auto number = [](double x) { return io::json_number(x); };
  const auto yes = [](bool flag) { return flag ? "true" : "false"; };
  std::string supports;
  for (const fem::Support& s : beam.supports) {
    supports += (supports.empty() ? "[" : ",[") + number(s.at) + "," + yes(s.deflection) + "," +
                yes(s.rotation) + "," + (s.stiffness ? number(*s.stiffness) : "null") + "]";
  }
  return io::fingerprint(
      "{\"area\":" + number(beam.section.area) + ",\"density\":" + number(beam.material.density) +
      ",\"elements\":" + std::to_string(beam.elements) + ",\"length\":" + number(beam.length) +
      ",\"poisson\":" + number(beam.material.poisson) +
      ",\"second_moment\":" + number(beam.section.second_moment) +
      ",\"shear_coefficient\":" + number(beam.section.shear_coefficient) + ",\"supports\":[" +
      supports + "],\"young\":" + number(beam.material.young) + "}");
}

std::string table_name(int count) {
  return "count_" + std::to_string(count);
}

std::vector<double> intact_frequencies(const Table& pair) {
  return vector_of(pair.parameters.at("intact"));
}

void keep_intact_frequencies(Table& pair, std::span<const double> frequencies_hz) {
  pair.parameters["intact"] = row(frequencies_hz);
}

FrequencyTables read_frequency_tables(const std::filesystem::path& path, const fem::Beam& beam,
                                      int max_count, int modes) {
  auto file = emulator::read_table_file(
      path, {.expected_fingerprint = beam_fingerprint(beam), .allow_incomplete = true});
  if (const auto part = file.attributes.find("part"); part != file.attributes.end()) {
    throw io::FileError(
        io::FileError::Kind::corrupt, path,
        "holds part " + part->second + " of a table: merge the parts with wheeltap table --merge");
  }
  FrequencyTables out;
  for (int count = 1; count <= max_count; ++count) {
    const auto found = file.tables.find(table_name(count));
    if (found == file.tables.end()) break;
    Table& table = found->second;
    if (table.missing_runs() > 0) {
      throw io::FileError(io::FileError::Kind::corrupt, path,
                          "lacks " + std::to_string(table.missing_runs()) + " runs with " +
                              std::to_string(count) + " damages");
    }
    if (table.values.cols() < modes) {
      throw std::invalid_argument(path.string() + " holds " + std::to_string(table.values.cols()) +
                                  " modes, but the data have " + std::to_string(modes));
    }
    if (table.factors.size() != static_cast<std::size_t>(2 * count)) {
      throw io::FileError(io::FileError::Kind::foreign, path,
                          "is not a table of damages and frequencies");
    }
    const auto symmetrised = table.attributes.find("symmetrised");
    out.symmetrised = symmetrised != table.attributes.end() && symmetrised->second == "true";
    out.errors.push_back(error_of(table, count, path));
    out.tables.push_back(std::move(table));
  }
  if (out.tables.size() == 2 && out.tables[1].attributes.contains("anova")) {
    const Table& pair = out.tables[1];
    for (int count = 3; count <= max_count; ++count) {
      const auto found = pair.parameters.find(error_name(count));
      if (found == pair.parameters.end()) break;
      out.errors.push_back(error_from(found->second));
    }
    if (out.errors.size() > 2) out.anova = emulator::additive_named(pair.attributes.at("anova"));
  }
  if (static_cast<int>(out.errors.size()) < max_count) {
    throw std::invalid_argument(path.string() + " holds tables for up to " +
                                std::to_string(out.errors.size()) +
                                " damages, but the case allows " + std::to_string(max_count));
  }
  return out;
}

void write_frequency_tables(const std::filesystem::path& path, const fem::Beam& beam,
                            FrequencyTables tables, std::map<std::string, std::string> attributes) {
  for (std::size_t i = 0; i < tables.errors.size(); ++i) {
    const EmulatorError& error = tables.errors[i];
    Table& home = tables.tables[std::min(i, tables.tables.size() - 1)];
    if (!error.scale.empty()) {
      home.parameters[error_name(static_cast<int>(i) + 1)] = to_matrix(error);
    }
    if (!error.leave_one_out.empty()) home.parameters["leave_one_out"] = row(error.leave_one_out);
    if (i < tables.tables.size()) home.holdout = error.holdout;
  }
  emulator::TableFile file{.attributes = std::move(attributes), .tables = {}};
  file.attributes["fingerprint"] = beam_fingerprint(beam);
  for (std::size_t i = 0; i < tables.tables.size(); ++i) {
    file.tables[table_name(static_cast<int>(i) + 1)] = std::move(tables.tables[i]);
  }
  emulator::write_table_file(path, file);
}

}  // namespace wheeltap::identification
