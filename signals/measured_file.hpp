// The content of a measured file: channels with units, sampling, quality and spectra.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "io/formats/formats.hpp"
#include "io/universal/universal_file.hpp"
#include "signals/channel_quality.hpp"
#include "signals/record.hpp"

namespace wheeltap::signals {

struct MeasuredChannel {
  std::string name = {}, unit = {};
  int number = 0;  ///< number of the column in the file, from 1; 0: unknown
  /// A unit that the column's name suggests. Wheeltap does not convert values with this unit. Empty
  /// if the name suggests no unit.
  std::string possible_unit = {};
  std::vector<double> values = {};
  ChannelQuality quality = {};
  std::optional<Spectrum> spectrum = {};  ///< only for a time history with a known sampling rate
  std::vector<SpectrumPeak> peaks = {};
};

/// A column of the file that is not a channel.
struct LeftOutColumn {
  int number = 1;  ///< number of the column in the file, from 1
  std::string header = {};
  bool is_time_stamp = false;  ///< true: additional time stamps; false: strings or empty cells
  bool maybe_time = false;     ///< true: strings, possibly times, in a table without a time column
};

/// A table of columns with common sampling times.
struct MeasuredTable {
  std::string abscissa = {}, abscissa_unit = {};  ///< empty without an abscissa
  std::vector<double> x = {};                     ///< values of the abscissa; empty without an
                                                  ///< abscissa
  bool is_time = true;                            ///< true: the abscissa is time; false: a
                                                  ///< frequency or another quantity
  std::optional<double> sample_rate_hz = {};
  Sampling sampling = {};                      ///< sampling; only for a time column without faults
  std::optional<io::FoundLayout> layout = {};  ///< only for delimited text and workbooks
  std::vector<LeftOutColumn> left_out = {};
  std::string sampling_fault = {};  ///< a sentence: why the time column gives no sampling rate
  std::vector<MeasuredChannel> channels = {};

  [[nodiscard]] long rows() const;
  /// True if Wheeltap treats a channel as a time history, because the sampling rate is known or the
  /// channel is long enough.
  [[nodiscard]] bool is_record(const MeasuredChannel& channel) const;
};

struct MeasuredFile {
  std::filesystem::path path = {};
  std::string format = {};
  std::vector<MeasuredTable> tables = {};
  std::vector<std::string> others = {};  ///< descriptions of content other than channels
  std::optional<io::UniversalFile> universal = {};
};

/// Options for reading a file. If an option is empty, its value is detected.
struct MeasuredReading {
  std::optional<double> sample_rate_hz = {};  ///< sampling rate [Hz] of a file that does not state
                                              ///< its rate
  io::TextLayout layout = {};                 ///< layout of delimited text and Excel workbooks
  io::ArrayLayout arrays = {};                ///< layout of the arrays of MATLAB, NumPy, NetCDF and
                                              ///< HDF5 files
  bool resample = false;                      ///< interpolate records with uneven time steps to a
                                              ///< constant rate
  bool check = true;                          ///< call check_channels
};

/// Reads a file and checks its channels. Throws io::FileError, and std::invalid_argument for a rate
/// that is not positive.
[[nodiscard]] MeasuredFile look_at(const std::filesystem::path& path,
                                   const MeasuredReading& reading = {});

/// Computes quality, spectrum and peaks of each channel, in parallel.
void check_channels(MeasuredFile& file);

}  // namespace wheeltap::signals
