// The model of someone else's that a case names, ready to be asked.
#pragma once

#include <memory>

#include "apps/cases/outside_case.hpp"
#include "apps/report_json.hpp"
#include "apps/run_options.hpp"
#include "identification/emulation/remembered_model.hpp"

namespace wheeltap::apps {

/// What a run keeps of the model's answers, in its folder.
inline constexpr const char* kModelRuns = "model-runs.journal";

/// The model with these outputs, asked for its sizes where it can be, and what it has said before:
/// in the user's file, or, with --resume, in the run's. Its inputs are the unknowns in their own
/// order. Throws Failure (64 where a program may not be run: --allow-commands, or a host may not be
/// reached: --allow-hosts; this machine always may), io::FileError and
/// OutsideModelError.
[[nodiscard]] std::shared_ptr<identification::RememberedModel> open_outside(
    const CaseFile& file, const OutsideSpec& spec, int outputs, const CommonOptions& common);

/// What of it a summary tells: whose it is, how often it was asked, how wrong its emulator is.
[[nodiscard]] Report outside_report(const OutsideSpec& spec,
                                    const identification::OutsideModel& model,
                                    const identification::OutsideEmulator* emulator = nullptr);

}  // namespace wheeltap::apps
