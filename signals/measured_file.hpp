// A measured file: its channels with their units, sampling, quality and spectra.
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
  /// The unit that its name may mean and that is not applied; empty: none.
  std::string possible_unit = {};
  std::vector<double> values = {};
  ChannelQuality quality = {};
  std::optional<Spectrum> spectrum = {};  ///< of a time history with a known rate
  std::vector<SpectrumPeak> peaks = {};
};

/// A column that is no channel.
struct LeftOutColumn {
  int number = 1;  ///< from 1
  std::string header = {};
  bool is_time_stamp = false;  ///< further time stamps; otherwise texts or nothing
  bool maybe_time = false;     ///< a text in a table where no column of times was found
};

/// Columns that were sampled together.
struct MeasuredTable {
  std::string abscissa = {}, abscissa_unit = {};  ///< empty where there is none
  std::vector<double> x = {};                     ///< of the abscissa; empty where there is none
  bool is_time = true;                            ///< otherwise a spectrum or the like
  std::optional<double> sample_rate_hz = {};
  Sampling sampling = {};                      ///< where there is a time and no fault
  std::optional<io::FoundLayout> layout = {};  ///< of delimited text and workbooks
  std::vector<LeftOutColumn> left_out = {};
  std::string sampling_fault = {};  ///< why there is no rate, though there is a time: a sentence
  std::vector<MeasuredChannel> channels = {};

  [[nodiscard]] long rows() const;
  /// Whether a channel is a time history: of a known rate, or long enough to be taken for one.
  [[nodiscard]] bool is_record(const MeasuredChannel& channel) const;
};

struct MeasuredFile {
  std::filesystem::path path = {};
  std::string format = {};
  std::vector<MeasuredTable> tables = {};
  std::vector<std::string> others = {};  ///< what is no channel of the table, in words
  std::optional<io::UniversalFile> universal = {};
};

/// How a file is to be read; what is not stated is detected.
struct MeasuredReading {
  std::optional<double> sample_rate_hz = {};  ///< where the file says none
  io::TextLayout layout = {};                 ///< of delimited text and Excel workbooks
  io::ArrayLayout arrays = {};                ///< of MATLAB, NumPy, NetCDF and HDF5 files
  bool resample = false;                      ///< uneven records are interpolated at an even rate
};

/// Throws io::FileError, and std::invalid_argument for a rate that is not positive.
[[nodiscard]] MeasuredFile look_at(const std::filesystem::path& path,
                                   const MeasuredReading& reading = {});

}  // namespace wheeltap::signals
