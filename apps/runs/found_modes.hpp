// Natural frequencies of the beam or structure of a case.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "apps/cases/syntax/case_file.hpp"
#include "apps/report_json.hpp"
#include "identification/findings/remarks.hpp"

namespace wheeltap::apps {

struct ModesOptions {
  std::optional<int> modes;  ///< number of modes, including rigid-body modes
  bool truth = false;        ///< true: include the damage of the case's truth
  bool json = false;
  bool shapes = false;        ///< add the mode shapes to the JSON output
  std::filesystem::path vtk;  ///< VTK file for the structure and its mode shapes
};

struct FoundModes {
  /// Output of --json, with mode shapes if `shapes` is set
  Report report;
  std::string text;                                 ///< terminal text
  std::vector<identification::Remark> doubts = {};  ///< implausible values of the case
};
/// Computes the modes of a case. Throws Failure.
[[nodiscard]] FoundModes find_modes(CaseFile file, const ModesOptions& options);

}  // namespace wheeltap::apps
