// TDMS files of LabVIEW and other programs of National Instruments.
#pragma once

#include "io/tables/columns.hpp"

namespace wheeltap::io {

/// Segments of a lead-in, metadata and raw data (National Instruments, "TDMS File Format Internal
/// Structure"): channels of numbers or time stamps, interleaved or not, of either byte order, of
/// any number of segments. A channel is the column "channel", or "group/channel" where there are
/// several groups, with its property unit_string as unit; linear and polynomial scales that its
/// properties state (NI_Scale) are applied. Where its wf_increment says a time step there is a
/// column "time [s]", from wf_start_offset on. Channels of other lengths and those of texts are
/// among the table's `others`. Throws FileError: foreign for what is no such file; corrupt for one
/// that is cut off or damaged, holds no channel, has raw data of DAQmx or scales of other kinds,
/// with what to do.
[[nodiscard]] Columns parse_tdms(std::string bytes, const std::filesystem::path& name,
                                 const Wanted& wanted);

}  // namespace wheeltap::io
