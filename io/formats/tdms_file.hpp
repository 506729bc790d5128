// TDMS files of LabVIEW and other programs of National Instruments.
#pragma once

#include "io/tables/columns.hpp"

namespace wheeltap::io {

/// Parses a file of segments, each with a lead-in, metadata and raw data (National Instruments,
/// "TDMS File Format Internal Structure"). Channels hold numbers or time stamps; the raw data may
/// be interleaved and have either byte order. A channel becomes the column "channel", or
/// "group/channel" if the file has several groups. The property unit_string of a channel gives the
/// unit of the column. Linear and polynomial scales in the properties of a channel (NI_Scale) are
/// applied. If the property wf_increment gives a time step, the table has a column "time [s]" that
/// starts at wf_start_offset. Channels of another length and channels of strings are listed in the
/// table's `others`. Throws FileError: foreign for files of other formats; corrupt, with a remedy,
/// for a truncated or invalid file, for a file without channels, for raw data of DAQmx, and for
/// scales of other types.
[[nodiscard]] Columns parse_tdms(std::string bytes, const std::filesystem::path& name,
                                 const Wanted& wanted);

}  // namespace wheeltap::io
