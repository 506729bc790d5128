// Results of mode tracking over many tests: a NetCDF file and a table.
#pragma once

#include <filesystem>
#include <iosfwd>
#include <string>
#include <vector>

#include "apps/cases/monitoring/monitored_modes.hpp"

namespace wheeltap::apps {

/// Tests and the assignments of their modes, one assignment per test.
struct TrackedModesOf {
  const std::vector<MonitoredTest>& tests;
  const std::vector<identification::monitoring::TrackedRecord>& records;
  const std::vector<identification::monitoring::TrackedMode>& modes;
};

/// NetCDF-4 with the dimensions record and mode:
///
///   frequency, frequency_sd, damping (record, mode): of the assigned mode; NaN where it is
///   missing; probability (record, mode): of that assignment, or that the mode is missing; number
///   (record, mode): number of the mode in its file, 0: missing; mac (record, mode): with the
///   mode's reference shape; modes, spurious (record): identified modes, and the expected number
///   that is of no tracked mode; reference_frequency, scatter, detection (mode); the attribute
///   files: one name per line.
[[nodiscard]] std::string tracked_netcdf(const TrackedModesOf& tracked,
                                         const std::filesystem::path& path);

/// Prints one row per tracked mode.
void print_tracked(std::ostream& out, const TrackedModesOf& tracked, bool colour);

/// The rows of the table as JSON.
[[nodiscard]] Report tracked_report(const TrackedModesOf& tracked);

}  // namespace wheeltap::apps
