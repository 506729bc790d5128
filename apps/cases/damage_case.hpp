// A damage case file, parsed once at the door: everything behind it works on identification's
// types.
#pragma once

#include <string>
#include <vector>

#include "apps/cases/outside_case.hpp"
#include "apps/cases/syntax/case_file.hpp"
#include "apps/explained.hpp"
#include "identification/structural/damage/damage_case.hpp"

namespace wheeltap::apps {

struct DamageCaseFile {
  CaseFile file;
  std::vector<std::string> notes;
  identification::DamageCase damage;
  std::vector<Pointer> kinds;               ///< blocks of the damage's kinds, for complaints
  std::optional<OutsideSpec> outside = {};  ///< predicts in place of the FE solution

  /// What the library complains about, as a complaint about the case. Throws Failure.
  [[noreturn]] void refuse(const identification::InvalidInput& error) const;
};

/// What a command needs from the case's data.
enum class Needs {
  structure,  ///< the beam only (`modes`, `table` where no data are given)
  data        ///< frequencies, or a truth to simulate them from
};

/// Reads, checks and parses. Throws Failure.
[[nodiscard]] DamageCaseFile parse_damage_case(CaseFile file, Needs needs = Needs::data);

}  // namespace wheeltap::apps
