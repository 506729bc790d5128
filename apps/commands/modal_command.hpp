// `wheeltap modal CASE -o DIR`: identification of modes from records.
#pragma once

#include <string>

#include "apps/cases/modal_case.hpp"
#include "apps/results/summary.hpp"
#include "apps/run_options.hpp"
#include "signals/modal/modal_identification.hpp"

namespace wheeltap::apps {

/// Identified modes of a case, before the result files are written.
struct ModalRun {
  ModalCaseFile modal;
  IdentifiedModes found;
  ModesFile modes;
  double seconds = 0.0;

  /// The content of summary.json.
  [[nodiscard]] Report summary(const CommonOptions& common) const;
  /// Writes modes.json, poles.json, summary.json and report.html. Throws io::FileError.
  void keep(const std::filesystem::path& folder, const CommonOptions& common) const;
  void print(std::ostream& out, bool colour) const;
};
/// Identifies modes from the record `given`, or from the files that the case names. Throws Failure.
[[nodiscard]] ModalRun identify_modal(CaseFile file, const CommonOptions& common,
                                      std::optional<signals::Record> given = {});

/// Writes the files of ModalRun::keep into the output folder and prints the modes.
void run_modal(const CommonOptions& common);

}  // namespace wheeltap::apps
