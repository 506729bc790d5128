// A system-identification case file, parsed into the types of the identification library.
#pragma once

#include <string>
#include <vector>

#include "apps/cases/syntax/case_file.hpp"
#include "apps/explained.hpp"
#include "identification/sid/sid_case.hpp"

namespace wheeltap::apps {

struct SidCaseFile {
  CaseFile file;
  std::vector<std::string> notes;
  identification::SidCase sid;
  std::vector<Pointer> channels;  ///< locations of the channels in the case, for error messages

  /// Throws Failure with the message of the library's error and its location in the case.
  [[noreturn]] void refuse(const identification::InvalidInput& error) const;
};

/// Data that a command needs in addition to the models.
enum class SidNeeds {
  truth,  ///< the truth and its excitations
  record  ///< the record, from a file or simulated
};

/// Validates and parses a case. If the case does not name a record file, the record is simulated
/// from the truth. Throws Failure.
[[nodiscard]] SidCaseFile parse_sid_case(CaseFile file, SidNeeds needs = SidNeeds::record);

}  // namespace wheeltap::apps
