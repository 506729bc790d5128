// Natural frequencies of a case's beam or structure, for whoever shows them.
#pragma once

#include <string>
#include <vector>

#include "apps/case_file.hpp"
#include "apps/commands.hpp"
#include "apps/summary.hpp"
#include "identification/remarks.hpp"

namespace wheeltap::apps {

struct FoundModes {
  Report report;     ///< as --json prints it; shapes where `shapes` asks for them
  std::string text;  ///< as a terminal shows it
  std::vector<identification::Remark> doubts = {};  ///< what the case can hardly mean
};
/// Throws Failure.
[[nodiscard]] FoundModes find_modes(CaseFile file, const ModesOptions& options);

}  // namespace wheeltap::apps
