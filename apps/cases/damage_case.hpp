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
  /// JSON pointers to the kinds of damage in the case, for error messages
  std::vector<Pointer> kinds;
  std::optional<OutsideSpec> outside = {};  ///< external model that replaces the FE solution

  /// Throws Failure with the message of the library's error and its location in the case.
  [[noreturn]] void refuse(const identification::InvalidInput& error) const;
};

/// The part of the case's data that a command needs.
enum class Needs {
  structure,  ///< the structure only (commands `modes`, and `table` without data)
  data        ///< measured frequencies, or a truth from which frequencies are simulated
};

/// Validates and parses a case. Throws Failure.
[[nodiscard]] DamageCaseFile parse_damage_case(CaseFile file, Needs needs = Needs::data);

}  // namespace wheeltap::apps
