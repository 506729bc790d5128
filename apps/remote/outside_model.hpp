// Creation of the external models that a case names.
#pragma once

#include <memory>

#include "apps/cases/outside_case.hpp"
#include "apps/report_json.hpp"
#include "apps/run_options.hpp"
#include "identification/emulation/remembered_model.hpp"

namespace wheeltap::apps {

/// Name of the file in the folder of a run that stores the results of the model.
inline constexpr const char* kModelRuns = "model-runs.journal";

/// Opens the model with the given number of outputs and checks the sizes that the model reports, if
/// any. The model reads earlier results from the user's file or, with --resume, from the run's
/// journal. Its inputs are the unknowns. Throws Failure (64) if the case needs --allow-commands (a
/// program) or --allow-hosts (another machine). Also throws io::FileError and OutsideModelError.
[[nodiscard]] std::shared_ptr<identification::RememberedModel> open_outside(
    const CaseFile& file, const OutsideSpec& spec, int outputs, const CommonOptions& common);

/// Returns the part of a summary that describes the external model: origin, evaluations, emulator
/// errors.
[[nodiscard]] Report outside_report(const OutsideSpec& spec,
                                    const identification::OutsideModel& model,
                                    const identification::OutsideEmulator* emulator = nullptr);

}  // namespace wheeltap::apps
