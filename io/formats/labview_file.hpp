// Text-based measurement files of LabVIEW (.lvm).
#pragma once

#include "io/tables/columns.hpp"

namespace wheeltap::io {

/// A header of key and value lines, then segments, each with a header of its own (Channels,
/// Samples, Y_Unit_Label, X0, Delta_X, …), a line of column names and the samples (National
/// Instruments, "Specification for the LabVIEW Measurement File"). Of "One" X column or "Multi"ple
/// ones the first is the time; of "No" X columns the time is made from X0 and Delta_X. Segments of
/// the same channels follow each other; comments are left out. Separators: tab or comma, as the
/// header says; a decimal comma where it says so. Throws FileError: foreign for what is no such
/// file, corrupt, with the line, for a row that is no numbers or too short, segments of unlike
/// channels, and channels with unlike times.
[[nodiscard]] Columns parse_labview(std::string bytes, const std::filesystem::path& name,
                                    const Wanted& wanted);

}  // namespace wheeltap::io
