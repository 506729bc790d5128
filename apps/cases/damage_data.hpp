// What was measured of a damaged beam or structure: frequencies, shapes, a baseline.
#pragma once

#include "apps/cases/damage_case.hpp"

namespace wheeltap::apps {

/// Reads /data: frequencies, and shapes and covariances where there are any. Throws Failure.
void take_data(const CaseFile& file, identification::DamageCase& out);
/// Shapes of the truth, where there are sensors; the frequencies are simulated already. Throws
/// Failure, identification::InvalidInput.
void take_true_shapes(const CaseFile& file, identification::DamageCase& out);
/// Reads /baseline and compares the data with it. Throws Failure.
void take_baseline(const CaseFile& file, identification::DamageCase& out);

}  // namespace wheeltap::apps
