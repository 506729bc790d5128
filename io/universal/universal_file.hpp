// Universal files (UFF, UNV): datasets 15, 55, 58, 58b, 82, 151, 164, 2411, 2412,
// 2414 and 2420.
//
// A file is a sequence of datasets, each between two lines that hold "-1"; the line after the first
// holds its number. Formats: University of Cincinnati SDRL, "Universal File Formats for Modal
// Analysis Testing"; numbers in fixed columns, as Fortran wrote them. Datasets of other numbers are
// left out, and counted.
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

/// A node's degree of freedom: 1, 2, 3 are +x, +y, +z; 4, 5, 6 turns about them; negative ones
/// point the other way; 0 is a scalar.
struct UniversalDof {
  std::string entity = {};  ///< "NONE" in files is empty here
  int node = 0;
  int direction = 0;
};

/// An axis of a function: what it measures and in which units.
struct UniversalAxis {
  int quantity = 0;  ///< 8 displacement, 11 velocity, 12 acceleration, 13 force, 15 pressure,
                     ///< 17 time, 18 frequency, 0 unknown, 1 general
  std::array<int, 3> powers = {};  ///< of length, force and temperature
  std::string label = {};          ///< "NONE" in files is empty here
  std::string unit = {};
};

/// Dataset 58: a function at degrees of freedom, e.g. a time history or a frequency response.
struct UniversalFunction {
  std::array<std::string, 5> ids = {};
  int type = 0;  ///< 1 time response, 2 auto-, 3 cross-spectrum, 4 frequency response, 9 PSD, …
  int number = 0, version = 0, load_case = 0;
  UniversalDof response = {}, reference = {};
  bool is_complex = false;
  bool is_double = true;
  bool even = true;
  double first = 0.0, step = 0.0;  ///< abscissa, where even
  double z = 0.0;
  UniversalAxis abscissa = {}, numerator = {}, denominator = {}, z_axis = {};
  std::vector<double> x = {};  ///< as many as y; written where uneven
  std::vector<std::complex<double>> y = {};
  bool binary = false;      ///< 58b
  bool big_endian = false;  ///< of 58b
  std::ptrdiff_t line = 0;  ///< where its dataset begins in the file it came from
};

/// Dataset 55, or 2414 at nodes: values at nodes, e.g. a mode's shape. The numbers of 2414 stand as
/// those of 55 do.
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

  /// Mode number, frequency [Hz] and damping ratio, where the analysis says; NaN where not.
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
  int physical = 0, material = 0;  ///< numbers of tables
  int colour = 0;
  std::array<int, 3> beam = {};  ///< of beams: orientation node, sections at the ends
  std::vector<int> nodes = {};

  /// Whether it is of the family that has `beam`.
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

/// Dataset 82: nodes to be joined by lines; 0 lifts the pen.
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

/// Dataset 164. SI = value / factor: of length, force and temperature.
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
  std::map<int, int> left_out = {};  ///< how many datasets of each number were not read; 2414 where
                                     ///< its values are not at nodes

  /// Metres in the file's unit of length.
  [[nodiscard]] double metres() const { return units ? 1.0 / units->factors[0] : 1.0; }
};

/// `name` stands for the file in messages. Throws FileError: foreign for what is no universal file,
/// corrupt for a dataset that is cut off, or whose numbers are none or too few, with its line.
[[nodiscard]] UniversalFile parse_universal_file(const std::string& bytes,
                                                 const std::filesystem::path& name);
/// Throws as that, and for a file that is not there.
[[nodiscard]] UniversalFile read_universal_file(const std::filesystem::path& path);

/// The bytes of a file that reads as this; functions with `binary` as 58b. Abscissae of uneven
/// functions keep 6 digits where they are text, and all in single precision where they are not, as
/// the format has it.
[[nodiscard]] std::string universal_text(const UniversalFile& file);

/// Functions that share their abscissa, as a table: the abscissa, then a column a function, or two
/// (", real" and ", imaginary"). Values in SI where dataset 164 and the axes' powers say how, and
/// the axis names no unit itself. Throws FileError (corrupt) where there is no function, or where
/// they do not share their abscissa.
[[nodiscard]] Columns universal_columns(const UniversalFile& file,
                                        const std::filesystem::path& name);

/// For io/formats.
[[nodiscard]] Columns parse_universal_columns(std::string bytes, const std::filesystem::path& name,
                                              const Wanted& wanted);

/// "12:+Z": a degree of freedom in words; empty where it names no node.
[[nodiscard]] std::string dof_in_words(const UniversalDof& dof);
/// "x", "-z"; empty for rotations and where no direction is given.
[[nodiscard]] std::string translation_axis(const UniversalDof& dof);
/// "frequency response", …; "function of type 37" where nobody knows.
[[nodiscard]] std::string function_in_words(int type);

}  // namespace wheeltap::io
