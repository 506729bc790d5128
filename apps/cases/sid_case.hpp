// A system-identification case file, parsed once at the door: everything behind it works on
// identification's types.
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
  std::vector<Pointer> channels;  ///< blocks of the case's channels, for complaints

  /// What the library complains about, as a complaint about the case. Throws Failure.
  [[noreturn]] void refuse(const identification::InvalidInput& error) const;
};

/// What a command needs beside the models.
enum class SidNeeds {
  truth,  ///< what a simulation is driven by
  record  ///< the record, read or simulated
};

/// Reads, checks and parses. A case without a file is simulated from its truth. Throws Failure.
[[nodiscard]] SidCaseFile parse_sid_case(CaseFile file, SidNeeds needs = SidNeeds::record);

}  // namespace wheeltap::apps
