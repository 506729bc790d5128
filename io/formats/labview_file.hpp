// Text-based measurement files of LabVIEW (.lvm).
#pragma once

#include "io/tables/columns.hpp"

namespace wheeltap::io {

/// Parses a text-based measurement file. The file begins with a header, whose lines have a key and
/// a value; segments follow. Each segment has its own header (Channels, Samples, Y_Unit_Label, X0,
/// Delta_X, …), a line of column names and the samples (National Instruments, "Specification for
/// the LabVIEW Measurement File"). If the header entry X_Columns is "One" or "Multi", the first
/// column is the time. If the entry is "No", the time is computed from X0 and Delta_X. Segments of
/// the same channels are appended; comments are ignored. The header states the separator (tab or
/// comma) and the decimal mark. Throws FileError: foreign for files of other formats; corrupt, with
/// the line number, for a row that is too short or not numeric, for segments with different
/// channels, and for channels with different times.
[[nodiscard]] Columns parse_labview(std::string bytes, const std::filesystem::path& name,
                                    const Wanted& wanted);

}  // namespace wheeltap::io
