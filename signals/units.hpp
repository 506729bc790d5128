// Units of measured signals as written in file headers, and the conversion factors to SI units.
//
// To add a unit, add a line to the list in units.cpp.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "io/tables/columns.hpp"

namespace wheeltap::signals {

enum class Dimension { time, force, length, velocity, acceleration, frequency };

/// Returns the name of a physical dimension for messages: "a time", "a force", ….
[[nodiscard]] std::string_view name(Dimension dimension);

struct Unit {
  std::string_view name;
  Dimension dimension;
  double si;  ///< SI value = si · value
};

/// Returns the unit with this name, or std::nullopt for an unknown unit. The name may have any of
/// the usual spellings: "µs" and "us", "m/s^2", "m/s²", "m/s2", "m/s**2", "m/s/s", "m s^-2",
/// "ms^-2"; "sec", "seconds".
[[nodiscard]] std::optional<Unit> find_unit(std::string_view text);

/// Returns the order of the time derivative of displacement: 1 for a velocity, 2 for an
/// acceleration, 0 for all other dimensions.
[[nodiscard]] int derivative_order(Dimension dimension);

/// Lists the known units of a physical dimension for messages: "s, ms, …".
[[nodiscard]] std::string known_units(Dimension dimension);

/// Returns the SI unit of a physical dimension: "s", "N", "m", "m/s", "m/s^2" or "Hz".
[[nodiscard]] std::string_view si_unit(Dimension dimension);

/// Conversion of a column's numbers to SI: SI value = factor · number. All commands and file
/// formats use this conversion.
struct Conversion {
  enum class Basis {
    none,          ///< no unit: numbers are used unchanged
    unit,          ///< the header of the file, its line of units, or the case gives the unit
    foreign,       ///< unknown unit, or a unit of another physical dimension than expected: numbers
                   ///< are used unchanged
    stated_scale,  ///< the case gives the factor
  };
  Basis basis = Basis::none;
  std::string unit = {};  ///< unit as written in the file or the case
  double factor = 1.0;
  std::optional<Dimension> dimension = {};  ///< dimension of the unit; the expected dimension if
                                            ///< the unit is unknown
};

/// Returns the conversion of numbers with this unit to SI. If `wanted` is set, only units of this
/// dimension are converted. Without `wanted`, units of any dimension are converted.
[[nodiscard]] Conversion conversion_of(std::string_view unit, std::optional<Dimension> wanted = {});

/// Returns the unit of a column: the unit in brackets or in the line of units. If both are missing,
/// the function looks for a known unit at the end of the column's name. Such a unit follows " / ",
/// ", ", " in ", " - " or ": " ("Kraft / N", "force, N", "a in m/s²"), is enclosed in {} or <>, or
/// is a quotient at the end ("a m/s^2"). The result is empty if the column has no unit.
[[nodiscard]] std::string unit_of(const io::Column& column);

/// Returns a possible unit in a column's name that `unit_of` does not recognise: "acc_g",
/// "acc_m_s2", "F/N". Wheeltap does not apply this unit, because "acc_N" may mean north. The result
/// is empty for a name without a possible unit.
[[nodiscard]] std::string possible_unit_of(const io::Column& column);

/// Returns the unit of a time column by the rules of `unit_of` or, if they give none, a time unit
/// at the end of the column's name: "Time_ms", "t.us", "timeMillis", "timems", "Time since start in
/// ms". The result is empty if the column has no unit.
[[nodiscard]] std::string time_unit_of(const io::Column& column);

}  // namespace wheeltap::signals
