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

/// Prints an emulator's errors: per mode and with its warnings (`in_full`), or one line per count.
void print_emulator(std::ostream& out, const identification::EmulatorFinding& emulator, bool colour,
                    bool in_full);

/// Draws the beam as text of `width` characters: expected number of defects along it, beam,
/// supports.
[[nodiscard]] std::string draw_beam(const fem::Beam& beam, const std::vector<double>& expected,
                                    int width);

}  // namespace wheeltap::apps
