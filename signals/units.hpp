// Units of measured signals as written in file headers, and their factors to SI.
//
// To add a unit, add a line to the list in units.cpp.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "io/tables/columns.hpp"

namespace wheeltap::signals {

enum class Dimension { time, force, length, velocity, acceleration, frequency };

/// "a time", "a force", …: for messages.
[[nodiscard]] std::string_view name(Dimension dimension);

struct Unit {
  std::string_view name;
  Dimension dimension;
  double si;  ///< SI value = si · value
};

/// The unit with this name, or std::nullopt. Accepts the usual spellings: "µs" and "us", "m/s^2",
/// "m/s²", "m/s2", "m/s**2", "m/s/s", "m s^-2", "ms^-2"; "sec", "seconds".
[[nodiscard]] std::optional<Unit> find_unit(std::string_view text);

/// Number of differentiations of a displacement: 1 for a velocity, 2 for an acceleration, 0 for all
/// other dimensions.
[[nodiscard]] int derivative_order(Dimension dimension);

/// "s, ms, …": the known units, for messages.
[[nodiscard]] std::string known_units(Dimension dimension);

/// "s", "N", "m", "m/s", "m/s^2", "Hz".
[[nodiscard]] std::string_view si_unit(Dimension dimension);

/// Conversion of a column's numbers to SI: SI value = factor · number. All commands and file
/// formats use this conversion.
struct Conversion {
  enum class Basis {
    none,          ///< no unit: numbers are used unchanged
    unit,          ///< from the file's header, its line of units, or the case
    foreign,       ///< unknown unit, or another dimension than expected: numbers are used unchanged
    stated_scale,  ///< the case gives the factor
  };
  Basis basis = Basis::none;
  std::string unit = {};  ///< as in the file or the case
  double factor = 1.0;
  std::optional<Dimension> dimension = {};  ///< the unit's; the expected one if the unit is unknown
};

/// The conversion of numbers with this unit to SI. By default, any dimension is accepted, otherwise
/// only the expected one.
[[nodiscard]] Conversion conversion_of(std::string_view unit, std::optional<Dimension> wanted = {});

/// The unit of a column: the one in brackets or in the line of units, otherwise a known unit at the
/// end of the column's name after " / ", ", ", " in ", " - " or ": " ("Kraft / N", "force, N", "a
/// in m/s²"), in {} or <>, or a quotient as the last word ("a m/s^2"). Empty: none.
[[nodiscard]] std::string unit_of(const io::Column& column);

/// A possible unit in a column's name without one of these marks: "acc_g", "acc_m_s2", "F/N". It is
/// not applied, because "acc_N" may mean north. Empty: none.
[[nodiscard]] std::string possible_unit_of(const io::Column& column);

/// The unit of a time column: by the same rules, otherwise a time unit at the end of its name:
/// "Time_ms", "t.us", "timeMillis", "timems", "Time since start in ms". Empty: none.
[[nodiscard]] std::string time_unit_of(const io::Column& column);

}  // namespace wheeltap::signals
