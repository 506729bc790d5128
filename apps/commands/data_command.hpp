// `wheeltap data`: contents and faults of a measured file.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "apps/cases/records/measured_file.hpp"
#include "apps/results/summary.hpp"

namespace wheeltap::apps {

struct DataOptions {
  std::filesystem::path file;
  std::filesystem::path page;  ///< HTML file for the plots; empty: no plots
  std::string to;              ///< format of the converted file: csv, nc or uff, or a file name
  bool json = false;
  MeasuredReading reading = {};
};

/// The contents as JSON: {file, format, tables: [{rows, sample_rate_hz, channels: [{name, unit,
/// rms, peaks, …}, …]}, …]}.
[[nodiscard]] Report data_report(const MeasuredFile& file);

/// Prints channels, units, sampling, root mean squares, the faults of each channel and the peaks of
/// its spectrum; plots and converts on request. Throws io::FileError, Failure.
void run_data(const DataOptions& options);

}  // namespace wheeltap::apps
