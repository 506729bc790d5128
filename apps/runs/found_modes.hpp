// Natural frequencies of a case's beam or structure, for whoever shows them.
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
  std::optional<int> modes;  ///< rigid-body ones included
  bool truth = false;        ///< damaged as the case's truth says
  bool json = false;
  bool shapes = false;        ///< with json: add the shapes
  std::filesystem::path vtk;  ///< of a structure: draw it and its shapes into this file
};

struct FoundModes {
  Report report;     ///< as --json prints it; shapes where `shapes` asks for them
  std::string text;  ///< as a terminal shows it
  std::vector<identification::Remark> doubts = {};  ///< what the case can hardly mean
};
/// Throws Failure.
[[nodiscard]] FoundModes find_modes(CaseFile file, const ModesOptions& options);

}  // namespace wheeltap::apps
