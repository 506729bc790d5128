// The text of a damage run.
#pragma once

#include <iosfwd>
#include <string>
#include <vector>

#include "apps/cases/damage_case.hpp"
#include "identification/structural/damage/damage_findings.hpp"

namespace wheeltap::apps {

/// The text of a finished damage run.
void print_damage(std::ostream& out, const DamageCaseFile& damage_case,
                  const identification::DamageFindings& findings, bool colour);

/// An emulator's errors: per mode and with its warnings, or a line a count.
void print_emulator(std::ostream& out, const identification::EmulatorFinding& emulator, bool colour,
                    bool in_full);

/// The beam as text, `width` characters long: expected number of defects along it, the beam, its
/// supports.
[[nodiscard]] std::string draw_beam(const fem::Beam& beam, const std::vector<double>& expected,
                                    int width);

}  // namespace wheeltap::apps
