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
///   (record, mode): frequency, frequency_sd, damping of the assigned mode (NaN: missing);
///     probability of the assignment, or of "missing"; number of the mode in its file (0: missing);
///     mac with the reference shape of the tracked mode
///   (record): modes, number of identified modes; spurious, expected number of spurious modes
///   (mode): reference_frequency; scatter, sd of ln f; detection, probability of identification
///   attribute files: one name per line
[[nodiscard]] std::string tracked_netcdf(const TrackedModesOf& tracked,
                                         const std::filesystem::path& path);

/// Prints one row per tracked mode.
void print_tracked(std::ostream& out, const TrackedModesOf& tracked, bool colour);

/// The rows of the table as JSON.
[[nodiscard]] Report tracked_report(const TrackedModesOf& tracked);

}  // namespace wheeltap::apps
