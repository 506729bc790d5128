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
  std::optional<OutsideSpec> outside = {};  ///< predicts in place of the structure
};

enum class UpdateNeeds {
  structure,  ///< the structure only (`modes`)
  truth,      ///< simulated data, in place of measured data (`simulate`)
  data        ///< measured modes, or a truth to simulate them from
};

/// Validates and parses a case. With a truth and no modes, simulates the data with `seed`, or with
/// the truth's seed. Throws Failure.
[[nodiscard]] UpdateCaseFile parse_update_case(CaseFile file, UpdateNeeds needs = UpdateNeeds::data,
                                               std::optional<std::uint64_t> seed = {});

/// The place of a parameter's prior: /parameters/k1, /data/cov.
[[nodiscard]] Pointer prior_place(const identification::UpdateCase& update_case,
                                  const std::string& parameter);

}  // namespace wheeltap::apps
