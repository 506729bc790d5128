// Strong-motion records: PEER .AT2 (.VT2, .DT2) and CSMIP .V2 (.V1) files.
#pragma once

#include "io/tables/columns.hpp"

namespace wheeltap::io {

/// Parses a time history of the PEER ground motion database. The file begins with three lines of
/// text; the third line gives the quantity and its unit ("ACCELERATION TIME HISTORY IN UNITS OF
/// G"). The next line gives the number of points and the time step ("NPTS= 3930, DT= .00500 SEC",
/// or "3930 0.005 NPTS, DT"). The samples follow row by row. The columns are "time [s]" and the
/// quantity. Throws FileError (corrupt), with the line number, if the header gives no time step or
/// if the number of samples differs from the number in the header.
[[nodiscard]] Columns parse_peer(std::string bytes, const std::filesystem::path& name,
                                 const Wanted& wanted);

/// Parses a record of the California Strong Motion Instrumentation Program, volume 2 (corrected) or
/// volume 1 (uncorrected). A header "N points of accel data equally spaced at DT sec, in cm/sec2.
/// (8f10.5)" is followed by N numbers in columns of the stated width. Velocity and displacement
/// follow in the same form, then further channels. The columns are "time [s]" and "acceleration,
/// channel 1 [cm/s^2]" and so on. Throws FileError: foreign for a file without this header;
/// corrupt, with the line number, for an unreadable header, for invalid or missing numbers, and for
/// channels with different time steps or lengths.
[[nodiscard]] Columns parse_csmip(std::string bytes, const std::filesystem::path& name,
                                  const Wanted& wanted);

}  // namespace wheeltap::io
