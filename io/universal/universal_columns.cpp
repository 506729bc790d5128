// Converts the functions of a universal file to the columns of a table.
#include <algorithm>
#include <cmath>

#include "io/universal/universal_file.hpp"

namespace wheeltap::io {
namespace {

struct Quantity {
  int code;
  const char* name;
  const char* si;
};
// Codes of the field "specific data type", with their units.
constexpr Quantity kQuantities[] = {{2, "stress", "Pa"},
                                    {3, "strain", ""},
                                    {5, "temperature", "K"},
                                    {6, "heat flux", "W/m^2"},
                                    {8, "displacement", "m"},
                                    {9, "reaction force", "N"},
                                    {11, "velocity", "m/s"},
                                    {12, "acceleration", "m/s^2"},
                                    {13, "force", "N"},
                                    {15, "pressure", "Pa"},
                                    {16, "mass", "kg"},
                                    {17, "time", "s"},
                                    {18, "frequency", "Hz"},
                                    {19, "rpm", "1/min"},
                                    {20, "order", ""},
                                    {21, "sound pressure", "Pa"},
                                    {22, "sound intensity", "W/m^2"}};

const Quantity* quantity_of(const UniversalAxis& axis) {
  const auto* found = std::ranges::find(kQuantities, axis.quantity, &Quantity::code);
  return found == std::end(kQuantities) ? nullptr : found;
}

/// True if the unit of the quantity contains a length, a force or a mass.
bool depends_on_units(const Quantity& quantity) {
  constexpr int kOthers[] = {3, 5, 17, 18, 19, 20};  // strain, temperature, time and its inverse
  return std::ranges::find(kOthers, quantity.code) == std::end(kOthers);
}

struct Measured {
  std::string label, unit;
  double to_si = 1.0;
};

/// The label and unit of an axis. A unit given by the axis is used unchanged; otherwise the powers
/// of the units of dataset 164 give SI units. Writers that do not state the powers write zeros; the
/// unit is then known only if the units of dataset 164 are those of SI.
Measured measured(const UniversalAxis& axis, const std::optional<UniversalUnits>& units) {
  const Quantity* quantity = quantity_of(axis);
  Measured out{.label = axis.label, .unit = axis.unit};
  if (out.label.empty() && quantity != nullptr) out.label = quantity->name;
  if (!out.unit.empty() || quantity == nullptr || !units) return out;
  const auto is = [](double value) { return [value](double x) { return x == value; }; };
  if (depends_on_units(*quantity) && std::ranges::all_of(axis.powers, is(0.0)) &&
      !std::ranges::all_of(units->factors, is(1.0)))
    return out;
  out.unit = quantity->si;
  for (std::size_t k = 0; k < 3; ++k) out.to_si *= std::pow(units->factors[k], -axis.powers[k]);
  return out;
}

bool shares_abscissa(const UniversalFunction& a, const UniversalFunction& b) {
  if (a.y.size() != b.y.size()) return false;
  if (a.even && b.even) return a.first == b.first && a.step == b.step;
  return a.x == b.x;
}

std::string header_of(const std::string& name, const std::string& unit) {
  return unit.empty() ? name : name + " [" + unit + "]";
}

}  // namespace

std::string dof_in_words(const UniversalDof& dof) {
  static constexpr const char* kDirections[] = {"", "X", "Y", "Z", "RX", "RY", "RZ"};
  if (dof.node == 0 && dof.direction == 0) return {};
  std::string text = std::to_string(dof.node);
  const int direction = std::abs(dof.direction);
  if (direction >= 1 && direction <= 6)
    text += std::string(":") + (dof.direction < 0 ? "-" : "+") + kDirections[direction];
  return text;
}

std::string translation_axis(const UniversalDof& dof) {
  static constexpr const char* kAxes[] = {"", "x", "y", "z"};
  const int axis = std::abs(dof.direction);
  if (axis < 1 || axis > 3) return {};
  return std::string(dof.direction < 0 ? "-" : "") + kAxes[axis];
}

std::string function_in_words(int type) {
  static constexpr const char* kTypes[] = {"general or unknown",
                                           "time response",
                                           "auto-spectrum",
                                           "cross-spectrum",
                                           "frequency response",
                                           "transmissibility",
                                           "coherence",
                                           "auto-correlation",
                                           "cross-correlation",
                                           "power spectral density",
                                           "energy spectral density",
                                           "probability density",
                                           "spectrum",
                                           "cumulative frequency distribution",
                                           "peaks and valleys",
                                           "stress per cycle",
                                           "strain per cycle",
                                           "orbit",
                                           "mode indicator function",
                                           "force pattern",
                                           "partial power",
                                           "partial coherence",
                                           "eigenvalue",
                                           "eigenvector",
                                           "shock response spectrum",
                                           "finite impulse response filter",
                                           "multiple coherence",
                                           "order function"};
  if (type >= 0 && type < static_cast<int>(std::size(kTypes))) return kTypes[type];
  return "function of type " + std::to_string(type);
}

Columns universal_columns(const UniversalFile& file, const std::filesystem::path& name) {
  if (file.functions.empty())
    throw FileError(FileError::Kind::corrupt, name, "holds no functions (dataset 58)");
  const UniversalFunction& first = file.functions.front();
  Columns out{.file = name.string()};
  const Measured abscissa = measured(first.abscissa, file.units);
  const std::string label = abscissa.label.empty() ? "abscissa" : abscissa.label;
  const auto add = [&](std::string column, const std::string& unit, std::vector<double> values) {
    // Append a number to repeated names.
    const std::string base = column;
    for (int again = 2; std::ranges::count(out.columns, column, &Column::name) > 0; ++again)
      column = base + " (" + std::to_string(again) + ")";
    out.columns.push_back({.header = header_of(column, unit),
                           .name = column,
                           .unit = unit,
                           .values = std::move(values)});
  };
  std::vector<double> x = first.x;
  for (double& value : x) value *= abscissa.to_si;
  add(label, abscissa.unit, std::move(x));
  for (const UniversalFunction& f : file.functions) {
    if (!shares_abscissa(first, f))
      throw FileError(
          FileError::Kind::corrupt, name, {.line = f.line},
          "the abscissa of this function differs from that of the first function: a table needs "
          "one common abscissa");
    const Measured over = measured(f.numerator, file.units);
    const Measured under = measured(f.denominator, file.units);
    std::string column = dof_in_words(f.response);
    const std::string from = dof_in_words(f.reference);
    if (!column.empty() && !from.empty() && f.type > 1) column += " / " + from;
    std::string what = over.label;
    if (what.empty()) what = f.response.entity;
    if (what.empty()) what = f.ids[0] == "NONE" ? "" : f.ids[0];
    if (!what.empty()) column += (column.empty() ? "" : " ") + what;
    if (column.empty()) column = function_in_words(f.type);
    std::string unit = over.unit;
    if (!under.unit.empty()) unit += "/" + under.unit;
    const double scale = over.to_si / under.to_si;
    std::vector<double> real, imaginary;
    for (const auto& y : f.y) {
      real.push_back(scale * y.real());
      if (f.is_complex) imaginary.push_back(scale * y.imag());
    }
    add(f.is_complex ? column + ", real" : column, unit, std::move(real));
    if (f.is_complex) add(column + ", imaginary", unit, std::move(imaginary));
  }
  return out;
}

Columns parse_universal_columns(std::string bytes, const std::filesystem::path& name,
                                const Wanted& wanted) {
  Columns out = universal_columns(parse_universal_file(bytes, name), name);
  if (wanted)
    for (std::size_t i = 0; i < out.columns.size(); ++i)
      if (!wanted(out, i)) out.columns[i].values.clear();
  return out;
}

}  // namespace wheeltap::io
