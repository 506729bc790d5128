// `wheeltap data`: what a measured file holds.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "apps/cases/records/measured_file.hpp"
#include "apps/results/summary.hpp"

namespace wheeltap::apps {

struct DataOptions {
  std::filesystem::path file;
  std::filesystem::path page;  ///< draw it into this HTML file
  std::string to;              ///< csv, nc or uff, or a file with such an ending: convert
  bool json = false;
  MeasuredReading reading = {};
};

/// {file, format, tables: [{rows, sample_rate_hz, channels: [{name, unit, rms, peaks, …}, …]}, …]}.
[[nodiscard]] Report data_report(const MeasuredFile& file);

/// Prints channels, units, sampling, root mean squares, what is odd about each channel and the
/// peaks of its spectrum; draws and converts where asked. Throws io::FileError, Failure.
void run_data(const DataOptions& options);

}  // namespace wheeltap::apps
