// Measured data of a damaged beam or structure: frequencies, shapes, a baseline.
#pragma once

#include "apps/cases/damage_case.hpp"

namespace wheeltap::apps {

/// Parses /data: frequencies, and shapes and covariances if given. Throws Failure.
void take_data(const CaseFile& file, identification::DamageCase& out);
/// Simulates mode shapes of the true structure if the case has sensors. The frequencies must have
/// been simulated before. Throws Failure, identification::InvalidInput.
void take_true_shapes(const CaseFile& file, identification::DamageCase& out);
/// Parses /baseline and compares the data with the baseline. Throws Failure.
void take_baseline(const CaseFile& file, identification::DamageCase& out);

}  // namespace wheeltap::apps
