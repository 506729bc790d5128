// An update case file, parsed into the types of the identification library.
#pragma once

#include <string>
#include <vector>

#include "apps/cases/outside_case.hpp"
#include "identification/structural/updating/update_case.hpp"

namespace wheeltap::apps {

struct UpdateCaseFile {
  CaseFile file;
  std::vector<std::string> notes;
  identification::UpdateCase update;
  std::optional<OutsideSpec> outside = {};  ///< external model that replaces the structure
};

enum class UpdateNeeds {
  structure,  ///< the structure only (`modes`)
  truth,      ///< simulated data instead of measured data (`simulate`)
  data        ///< measured modes, or a truth from which modes are simulated
};

/// Validates and parses a case. If the case has "truth" and no modes, the function simulates the
/// data with `seed`. If `seed` is empty, it uses the key "seed" of "truth". Throws Failure.
[[nodiscard]] UpdateCaseFile parse_update_case(CaseFile file, UpdateNeeds needs = UpdateNeeds::data,
                                               std::optional<std::uint64_t> seed = {});

/// The location of a parameter's prior in the case: /parameters/k1, /data/cov.
[[nodiscard]] Pointer prior_place(const identification::UpdateCase& update_case,
                                  const std::string& parameter);

}  // namespace wheeltap::apps
