// An update case file, parsed once at the door.
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
  std::optional<OutsideSpec> outside = {};  ///< predicts in place of the structure
};

enum class UpdateNeeds {
  structure,  ///< nothing more (`modes`)
  truth,      ///< simulated data, whatever else there is (`simulate`)
  data        ///< measured modes, or a truth to simulate them from
};

/// Reads, checks and parses; simulates the data where the case has a truth and no modes, with
/// `seed` or the truth's own. Throws Failure.
[[nodiscard]] UpdateCaseFile parse_update_case(CaseFile file, UpdateNeeds needs = UpdateNeeds::data,
                                               std::optional<std::uint64_t> seed = {});

/// Where the prior of a parameter stands: /parameters/k1, /data/cov.
[[nodiscard]] Pointer prior_place(const identification::UpdateCase& update_case,
                                  const std::string& parameter);

}  // namespace wheeltap::apps
