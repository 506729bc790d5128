// Units of what a system identification infers, from where each parameter is used and from the
// units of the channels: SI, unless a channel is used in a unit that is not.
#pragma once

#include <map>
#include <optional>
#include <string>

#include "identification/sid/sid_case.hpp"

namespace wheeltap::identification {

/// The units in which a chain's coefficients come out: of force and length. A record of a force in
/// V and a displacement in V has stiffnesses in V/V; a force that drives nothing is in N.
struct UnitSystem {
  std::string force = "N", length = "m";

  [[nodiscard]] bool is_si() const { return force == "N" && length == "m"; }
  /// A unit that is written with N and m, in this system: "N/m^3" is "V/V^3" where both are in V.
  [[nodiscard]] std::string in_place_of(const std::string& si) const;
};

/// The channels' own; nothing where they disagree, or where a rate is in a unit without a name for
/// its length.
[[nodiscard]] std::optional<UnitSystem> unit_system(const SidCase& sid_case);

/// Of each parameter of the case, by its name: "N/m", "kg", "1" for a plain number; empty where it
/// is used in places of different units, or the channels' units say nothing of it.
[[nodiscard]] std::map<std::string, std::string> parameter_units(const SidCase& sid_case);

}  // namespace wheeltap::identification
