// A damage case file, parsed into the types of the identification library.
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
  std::vector<Pointer> kinds;               ///< blocks of the damage kinds, for error messages
  std::optional<OutsideSpec> outside = {};  ///< predicts in place of the FE solution

  /// Throws Failure: the library's error, located in the case.
  [[noreturn]] void refuse(const identification::InvalidInput& error) const;
};

/// The part of the case's data that a command needs.
enum class Needs {
  structure,  ///< the beam only (`modes`; `table` without data)
  data        ///< frequencies, or a truth to simulate them from
};

/// Validates and parses a case. Throws Failure.
[[nodiscard]] DamageCaseFile parse_damage_case(CaseFile file, Needs needs = Needs::data);

}  // namespace wheeltap::apps
