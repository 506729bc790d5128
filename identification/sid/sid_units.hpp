// Units of inferred parameters, derived from their uses and from the units of the channels. They
// are SI units unless a channel is used in a unit that Wheeltap cannot convert.
#pragma once

#include <map>
#include <optional>
#include <string>

#include "identification/sid/sid_case.hpp"

namespace wheeltap::identification {

/// Units of force and length for a chain's coefficients. With force and displacement records in V,
/// stiffnesses are in V/V; if no channel measures a force, its unit is N.
struct UnitSystem {
  std::string force = "N", length = "m";

  [[nodiscard]] bool is_si() const { return force == "N" && length == "m"; }
  /// Translates a unit written with N and m: "N/m^3" is "V/V^3" if both are in V.
  [[nodiscard]] std::string in_place_of(const std::string& si) const;
};

/// The channels' unit system; empty if they disagree, or if a rate's unit has no name for its
/// length.
[[nodiscard]] std::optional<UnitSystem> unit_system(const SidCase& sid_case);

/// The unit of each parameter of the case, by name: "N/m", "kg", "1" if dimensionless. Empty if its
/// uses have different units or the channels' units do not determine it.
[[nodiscard]] std::map<std::string, std::string> parameter_units(const SidCase& sid_case);

}  // namespace wheeltap::identification
