// Units of measured signals, as headers of files write them, and their factors to SI.
//
// To add one: a line in the list of units.cpp.
#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace wheeltap::signals {

enum class Dimension { time, force, length, velocity, acceleration };

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

/// "s, ms, …": what a message may say is known.
[[nodiscard]] std::string known_units(Dimension dimension);

}  // namespace wheeltap::signals
