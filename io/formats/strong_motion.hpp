// Strong-motion records: PEER .AT2 (.VT2, .DT2) and CSMIP .V2 (.V1) files.
#pragma once

#include "io/tables/columns.hpp"

namespace wheeltap::io {

/// A time history of the PEER ground motion database. Three lines of text; the last one gives the
/// quantity and its unit ("ACCELERATION TIME HISTORY IN UNITS OF G"). Then a line with the number
/// of points and the time step ("NPTS= 3930, DT= .00500 SEC", or "3930 0.005 NPTS, DT"), then
/// numbers row by row. The columns are "time [s]" and the quantity. Throws FileError (corrupt),
/// with the line, if the header gives no time step or the number of values differs from the header.
[[nodiscard]] Columns parse_peer(std::string bytes, const std::filesystem::path& name,
                                 const Wanted& wanted);

/// Records of the California Strong Motion Instrumentation Program, volume 2 (corrected) or 1. A
/// header "N points of accel data equally spaced at DT sec, in cm/sec2. (8f10.5)" is followed by N
/// numbers in columns of that width; velocity and displacement likewise, then further channels. The
/// columns are "time [s]" and "acceleration, channel 1 [cm/s^2]" and so on. Throws FileError:
/// foreign if there is no such header; corrupt, with the line, for an unreadable header, for
/// invalid or missing numbers, and for channels with different time steps or lengths.
[[nodiscard]] Columns parse_csmip(std::string bytes, const std::filesystem::path& name,
                                  const Wanted& wanted);

}  // namespace wheeltap::io
