// Units of inferred parameters, derived from their uses and from the units of the channels. The
// units are SI units, unless a channel has a unit that Wheeltap cannot convert.
#pragma once

#include <map>
#include <optional>
#include <string>

#include "identification/sid/sid_case.hpp"

namespace wheeltap::identification {

/// Units of force and length for the coefficients of a chain of masses. For example, if force and
/// displacement are in V, stiffnesses are in V/V. If no channel measures force, the unit is N.
struct UnitSystem {
  std::string force = "N", length = "m";

  [[nodiscard]] bool is_si() const { return force == "N" && length == "m"; }
  /// Replaces N and m in a unit by the units of the channels: "N/m^3" becomes "V/V^3" if force and
  /// displacement are in V.
  [[nodiscard]] std::string in_place_of(const std::string& si) const;
};

/// The unit system of the channels. The result is empty if the channels have different units, or if
/// the unit of a rate does not contain a unit of length.
[[nodiscard]] std::optional<UnitSystem> unit_system(const SidCase& sid_case);

/// The unit of each parameter of the case, by name: "N/m", "kg", "1" if dimensionless. The unit is
/// empty if the uses of the parameter have different units, or if the units of the channels do not
/// determine the unit.
[[nodiscard]] std::map<std::string, std::string> parameter_units(const SidCase& sid_case);

}  // namespace wheeltap::identification
