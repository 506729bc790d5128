// Terminal text of a damage run.
#pragma once

#include <iosfwd>
#include <string>
#include <vector>

#include "apps/cases/damage_case.hpp"
#include "identification/structural/damage/findings/damage_findings.hpp"

namespace wheeltap::apps {

/// Prints the results of a finished damage run.
void print_damage(std::ostream& out, const DamageCaseFile& damage_case,
                  const identification::DamageFindings& findings, bool colour);

/// Prints the errors of an emulator. With `in_full`, prints the errors per mode and warnings;
/// without it, one line per number of damages.
void print_emulator(std::ostream& out, const identification::EmulatorFinding& emulator, bool colour,
                    bool in_full);

/// Draws the beam as text of `width` characters: the expected number of defects along the beam, the
/// beam and the supports.
[[nodiscard]] std::string draw_beam(const fem::Beam& beam, const std::vector<double>& expected,
                                    int width);

}  // namespace wheeltap::apps
