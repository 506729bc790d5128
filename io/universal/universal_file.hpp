// Universal files (UFF, UNV): datasets 15, 55, 58, 58b, 82, 151, 164, 2411, 2412, 2414 and 2420.
//
// A file is a sequence of datasets, each between two lines that hold "-1"; the line after the first
// "-1" holds the dataset's number. Formats: University of Cincinnati SDRL, "Universal File Formats
// for Modal Analysis Testing"; numbers in fixed columns, as written by Fortran. Other datasets are
// skipped and counted.
#pragma once

#include <array>
#include <complex>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "io/tables/columns.hpp"

namespace wheeltap::io {

/// A degree of freedom of a node: 1, 2, 3 are +x, +y, +z; 4, 5, 6 rotations about them; negative
/// numbers have the opposite direction; 0 is a scalar.
struct UniversalDof {
  std::string entity = {};  ///< "NONE" in files is empty here
  int node = 0;
  int direction = 0;
};

/// An axis of a function: its quantity and units.
struct UniversalAxis {
  int quantity = 0;  ///< 8 displacement, 11 velocity, 12 acceleration, 13 force, 15 pressure,
                     ///< 17 time, 18 frequency, 0 unknown, 1 general
  std::array<int, 3> powers = {};  ///< powers of length, force, temperature
  std::string label = {};          ///< "NONE" in files is empty here
  std::string unit = {};
};

/// Dataset 58: a function at one or two degrees of freedom, e.g. a time history or a frequency
/// response.
struct UniversalFunction {
  std::array<std::string, 5> ids = {};
  int type = 0;  ///< 1 time response, 2 auto-, 3 cross-spectrum, 4 frequency response, 9 PSD, …
  int number = 0, version = 0, load_case = 0;
  UniversalDof response = {}, reference = {};
  bool is_complex = false;
  bool is_double = true;
  bool even = true;
  double first = 0.0, step = 0.0;  ///< abscissa, if evenly spaced
  double z = 0.0;
  UniversalAxis abscissa = {}, numerator = {}, denominator = {}, z_axis = {};
  std::vector<double> x = {};  ///< as many as y; written if unevenly spaced
  std::vector<std::complex<double>> y = {};
  bool binary = false;      ///< 58b
  bool big_endian = false;  ///< byte order of 58b
  std::ptrdiff_t line = 0;  ///< line of its dataset in the original file
};

/// Dataset 55, or 2414 at nodes: values at nodes, e.g. a mode shape. The numbers of 2414 are mapped
/// to those of 55.
struct UniversalShape {
  std::array<std::string, 5> ids = {};
  int model = 0;     ///< 1 structural
  int analysis = 0;  ///< 2 normal mode, 3 complex eigenvalue (first order), 5 FRF, 7 complex (2nd)
  int characteristic = 0;  ///< 2: three translations, 3: six motions, …
  int quantity = 0;        ///< 8 displacement, …
  bool is_complex = false;
  int values_a_node = 0;
  std::vector<int> integers = {};
  std::vector<double> reals = {};
  std::vector<int> nodes = {};
  std::vector<std::complex<double>> values = {};  ///< nodes × values_a_node
  std::ptrdiff_t line = 0;

  /// Mode number, frequency [Hz] and damping ratio; NaN if the analysis does not give them.
  [[nodiscard]] int mode() const;
  [[nodiscard]] double frequency_hz() const;
  [[nodiscard]] double damping() const;
};

/// Dataset 15, or 2411.
struct UniversalNode {
  int label = 0;
  int definition = 0, displacement = 0;  ///< coordinate systems
  int colour = 0;
  std::array<double, 3> at = {};  ///< in the file's unit of length
  bool is_double = false;         ///< written to 17 digits (2411)
};

/// Dataset 2412: a finite element.
struct UniversalElement {
  int label = 0;
  int descriptor = 0;  ///< 11 rod, 21 beam, 41 triangle, 44 quadrilateral, 94 shell, 111 solid, …
  int physical = 0, material = 0;  ///< numbers of property tables
  int colour = 0;
  std::array<int, 3> beam = {};  ///< orientation node, sections at the ends
  std::vector<int> nodes = {};

  /// True if the element belongs to the family with `beam`.
  [[nodiscard]] bool is_beam() const { return descriptor >= 11 && descriptor <= 24; }
};

/// Dataset 2420: a coordinate system of a part.
struct UniversalSystem {
  int label = 0;
  int kind = 0;  ///< 0 Cartesian, 1 cylindrical, 2 spherical
  int colour = 0;
  std::string name = {};
  /// Rows: its axes in the part's coordinates, then its origin.
  std::array<std::array<double, 3>, 4> axes = {};
};

/// Dataset 82: nodes to be joined by lines; 0 starts a new line.
struct UniversalTrace {
  int number = 0;
  int colour = 0;
  std::string id = {};
  std::vector<int> nodes = {};
};

/// Dataset 151.
struct UniversalHeader {
  std::array<std::string, 7> lines = {};  ///< model, description, program, created, saved, …
};

/// Dataset 164. SI = value / factor, with one factor each for length, force and
/// temperature.
struct UniversalUnits {
  int code = 1;  ///< 1: SI
  std::string description = {};
  int temperature_mode = 0;
  std::array<double, 3> factors = {1.0, 1.0, 1.0};
  double temperature_offset = 0.0;
};

struct UniversalFile {
  std::optional<UniversalHeader> header = {};
  std::optional<UniversalUnits> units = {};
  std::vector<UniversalNode> nodes = {};
  std::vector<UniversalTrace> traces = {};
  std::vector<UniversalElement> elements = {};
  std::vector<UniversalSystem> systems = {};
  std::vector<UniversalShape> shapes = {};
  std::vector<UniversalFunction> functions = {};
  std::map<int, int> left_out = {};  ///< number of datasets of each number that were skipped; 2414
                                     ///< if its values are not at nodes

  /// Metres per unit of length of the file.
  [[nodiscard]] double metres() const { return units ? 1.0 / units->factors[0] : 1.0; }
};

/// Parses a file; messages use `name`. Throws FileError: foreign for other files; corrupt, with the
/// line, for a truncated dataset and for invalid or missing numbers.
[[nodiscard]] UniversalFile parse_universal_file(const std::string& bytes,
                                                 const std::filesystem::path& name);
/// Reads and parses a file. Throws the exceptions of parse_universal_file, and FileError (missing).
[[nodiscard]] UniversalFile read_universal_file(const std::filesystem::path& path);

/// The bytes of a file with this content; functions with `binary` are written as 58b. The format
/// stores abscissae of unevenly spaced functions with 6 digits as text, and in single precision as
/// binary.
[[nodiscard]] std::string universal_text(const UniversalFile& file);

/// Converts functions with a common abscissa to a table: the abscissa, then one column per
/// function, or two (", real" and ", imaginary"). Values are converted to SI if dataset 164 and the
/// powers of the axes define the units, and the axis does not name a unit. Throws FileError
/// (corrupt) if there is no function, or if the abscissae differ.
[[nodiscard]] Columns universal_columns(const UniversalFile& file,
                                        const std::filesystem::path& name);

/// Parses a file to a table, for the list of formats in io/formats.
[[nodiscard]] Columns parse_universal_columns(std::string bytes, const std::filesystem::path& name,
                                              const Wanted& wanted);

/// "12:+Z": name of a degree of freedom; empty if it has no node.
[[nodiscard]] std::string dof_in_words(const UniversalDof& dof);
/// "x", "-z"; empty for rotations and unknown directions.
[[nodiscard]] std::string translation_axis(const UniversalDof& dof);
/// "frequency response", …; "function of type 37" for an unknown type.
[[nodiscard]] std::string function_in_words(int type);

}  // namespace wheeltap::io
