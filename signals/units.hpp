// Units of measured signals, as headers of files write them, and their factors to SI.
//
// To add one: a line in the list of units.cpp.
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

/// The unit that this text names, or nothing. Spellings are taken as meant: "µs" and "us",
/// "m/s^2", "m/s²", "m/s2", "m/s**2", "m/s/s", "m s^-2", "ms^-2"; "sec", "seconds".
[[nodiscard]] std::optional<Unit> find_unit(std::string_view text);

/// How often a displacement is differentiated to this: 1 of a velocity, 2 of an acceleration, 0 of
/// all else.
[[nodiscard]] int derivative_order(Dimension dimension);

/// "s, ms, …": what a message may say is known.
[[nodiscard]] std::string known_units(Dimension dimension);

/// "s", "N", "m", "m/s", "m/s^2", "Hz".
[[nodiscard]] std::string_view si_unit(Dimension dimension);

/// How the numbers of a column become SI: SI value = factor · number. The one rule for all commands
/// and formats.
struct Conversion {
  enum class Basis {
    none,          ///< no unit: numbers are used as they are
    unit,          ///< of the file's header, its line of units, or the case
    foreign,       ///< the unit is not known, or not of the dimension wanted: used as it is
    stated_scale,  ///< the case says the factor
  };
  Basis basis = Basis::none;
  std::string unit = {};  ///< as the file or the case has it
  double factor = 1.0;
  std::optional<Dimension> dimension = {};  ///< of the unit; where none is known, the one wanted
};

/// Of numbers in this unit that should be of this dimension; of any, where none is wanted.
[[nodiscard]] Conversion conversion_of(std::string_view unit, std::optional<Dimension> wanted = {});

/// The unit of a column: that in brackets or in the line of units, else a known one that ends its
/// name behind " / ", ", ", " in ", " - " or ": " ("Kraft / N", "force, N", "a in m/s²"), in {} or
/// <>, or a quotient that is the last word ("a m/s^2"). Empty: none.
[[nodiscard]] std::string unit_of(const io::Column& column);

/// The unit that a name without one may mean: "acc_g", "acc_m_s2", "F/N". It is not applied:
/// "acc_N" may be north. Empty: none.
[[nodiscard]] std::string possible_unit_of(const io::Column& column);

/// The unit of a column of times: as above, else one of time that is the last word of its name:
/// "Time_ms", "t.us", "timeMillis", "timems", "Time since start in ms". Empty: none.
[[nodiscard]] std::string time_unit_of(const io::Column& column);

}  // namespace wheeltap::signals
