// Universal files (UFF, UNV): datasets 15, 55, 58, 58b, 82, 151, 164, 2411, 2412, 2414 and 2420.
// A file is a sequence of datasets. Each dataset is between two lines that hold "-1"; the line
// after the first "-1" holds the number of the dataset. Numbers are in fixed columns, as written by
// Fortran. The formats are those of University of Cincinnati SDRL, "Universal File Formats for
// Modal Analysis Testing". Datasets with other numbers are skipped and counted.
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

/// A degree of freedom of a node. The directions 1, 2, 3 are translations along +x, +y, +z; 4, 5, 6
/// are rotations about these axes. A negative number means the opposite direction, and 0 a scalar.
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
/// response function.
struct UniversalFunction {
  std::array<std::string, 5> ids = {};
  int type = 0;  ///< 1 time response, 2 auto-, 3 cross-spectrum, 4 frequency response function, 9
                 ///< PSD, …
  int number = 0, version = 0, load_case = 0;
  UniversalDof response = {}, reference = {};
  bool is_complex = false;
  bool is_double = true;
  bool even = true;
  double first = 0.0, step = 0.0;  ///< first value and increment of an evenly spaced abscissa
  double z = 0.0;
  UniversalAxis abscissa = {}, numerator = {}, denominator = {}, z_axis = {};
  std::vector<double> x = {};  ///< one abscissa per y, if unevenly spaced
  std::vector<std::complex<double>> y = {};
  bool binary = false;      ///< true: dataset 58b
  bool big_endian = false;  ///< byte order of 58b
  std::ptrdiff_t line = 0;  ///< line of its dataset in the original file
};

/// Dataset 55, or dataset 2414 with values at nodes: for example, a mode shape. The codes of
/// dataset 2414 are converted to those of dataset 55.
struct UniversalShape {
  std::array<std::string, 5> ids = {};
  int model = 0;     ///< 1 structural
  int analysis = 0;  ///< 2 normal mode, 3 complex eigenvalue (first order), 5 frequency response, 7
                     ///< complex eigenvalue (second order)
  int characteristic = 0;  ///< 2: three translations, 3: three translations and three rotations, …
  int quantity = 0;        ///< 8 displacement, …
  bool is_complex = false;
  int values_a_node = 0;
  std::vector<int> integers = {};
  std::vector<double> reals = {};
  std::vector<int> nodes = {};
  std::vector<std::complex<double>> values = {};  ///< nodes × values_a_node
  std::ptrdiff_t line = 0;

  /// Mode number, frequency [Hz] and damping ratio. Frequency and damping ratio are NaN if the
  /// analysis does not give them.
  [[nodiscard]] int mode() const;
  [[nodiscard]] double frequency_hz() const;
  [[nodiscard]] double damping() const;
};

/// Dataset 15 or 2411: a node.
struct UniversalNode {
  int label = 0;
  int definition = 0, displacement = 0;  ///< coordinate systems
  int colour = 0;
  std::array<double, 3> at = {};  ///< coordinates in the file's unit of length
  bool is_double = false;         ///< written with 17 digits (dataset 2411)
};

/// Dataset 2412: a finite element.
struct UniversalElement {
  int label = 0;
  int descriptor = 0;  ///< 11 rod, 21 beam, 41 triangle, 44 quadrilateral, 94 shell, 111 solid, …
  int physical = 0, material = 0;  ///< numbers of property tables
  int colour = 0;
  std::array<int, 3> beam = {};  ///< orientation node, sections at the ends
  std::vector<int> nodes = {};

  /// True if the element is a rod or beam. Files store the numbers `beam` for rods and beams only.
  [[nodiscard]] bool is_beam() const { return descriptor >= 11 && descriptor <= 24; }
};

/// Dataset 2420: a coordinate system of a part.
struct UniversalSystem {
  int label = 0;
  int kind = 0;  ///< 0 Cartesian, 1 cylindrical, 2 spherical
  int colour = 0;
  std::string name = {};
  /// The axes of the system (three rows) and its origin (last row), in the coordinates of the part.
  std::array<std::array<double, 3>, 4> axes = {};
};

/// Dataset 82: trace lines between nodes. In the list of node numbers, the number 0 starts a new
/// line.
struct UniversalTrace {
  int number = 0;
  int colour = 0;
  std::string id = {};
  std::vector<int> nodes = {};
};

/// Dataset 151: information on the model and the file.
struct UniversalHeader {
  std::array<std::string, 7> lines = {};  ///< model, description, program, created, saved, …
};

/// Dataset 164: the units of the file. A value in SI units is the value in the file divided by the
/// factor for length, force or temperature.
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
  std::map<int, int> left_out = {};  ///< number of skipped datasets, by dataset number, including
                                     ///< 2414 without nodal values

  /// The file's unit of length in metres.
  [[nodiscard]] double metres() const { return units ? 1.0 / units->factors[0] : 1.0; }
};

/// Parses a universal file; messages use `name` for the file. Throws FileError: foreign for other
/// formats; corrupt, with the line number, for a truncated dataset and for invalid or missing
/// numbers.
[[nodiscard]] UniversalFile parse_universal_file(const std::string& bytes,
                                                 const std::filesystem::path& name);
/// Reads and parses a universal file. Throws the same exceptions as parse_universal_file, and
/// FileError (missing).
[[nodiscard]] UniversalFile read_universal_file(const std::filesystem::path& path);

/// Returns the bytes of a universal file with this content. A function with `binary` = true is
/// written as dataset 58b. For unevenly spaced functions, the text format stores abscissae with 6
/// digits, and the binary format stores abscissae in single precision.
[[nodiscard]] std::string universal_text(const UniversalFile& file);

/// Converts the functions of a file to a table. All functions must have the same abscissa. The
/// first column is the abscissa. Each real function becomes one column, and each complex function
/// two columns (", real" and ", imaginary"). If the axis names no unit, but dataset 164 and the
/// powers of the axis determine the unit, values are converted to SI units. Throws FileError
/// (corrupt) if the file contains no function, or if the abscissae differ.
[[nodiscard]] Columns universal_columns(const UniversalFile& file,
                                        const std::filesystem::path& name);

/// Parses a universal file as a table; the list of formats in io/formats uses this function.
[[nodiscard]] Columns parse_universal_columns(std::string bytes, const std::filesystem::path& name,
                                              const Wanted& wanted);

/// Returns the name of a degree of freedom, for example "12:+Z", or an empty string if the degree
/// of freedom has no node.
[[nodiscard]] std::string dof_in_words(const UniversalDof& dof);
/// Returns the axis of a translation, for example "x" or "-z", or an empty string for rotations and
/// unknown directions.
[[nodiscard]] std::string translation_axis(const UniversalDof& dof);
/// Returns the name of a function type: "frequency response", …; "function of type 37" for an
/// unknown type.
[[nodiscard]] std::string function_in_words(int type);

}  // namespace wheeltap::io
