// A measured file, looked at: channels with their units, sampling and faults.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "io/universal/universal_file.hpp"
#include "signals/channel_quality.hpp"
#include "signals/record.hpp"

namespace wheeltap::apps {

struct MeasuredChannel {
  std::string name = {}, unit = {};
  std::vector<double> values = {};
  signals::ChannelQuality quality = {};
  std::optional<signals::Spectrum> spectrum = {};  ///< of a time history with a known rate
  std::vector<signals::SpectrumPeak> peaks = {};
};

/// Columns that were sampled together.
struct MeasuredTable {
  std::string abscissa = {}, abscissa_unit = {};  ///< empty where there is none
  std::vector<double> x = {};                     ///< of the abscissa; empty where there is none
  bool is_time = true;                            ///< otherwise a spectrum or the like
  std::optional<double> sample_rate_hz = {};
  signals::Sampling sampling = {};             ///< where there is a time and no fault
  std::optional<io::FoundLayout> layout = {};  ///< of delimited text and workbooks
  /// Columns that hold no numbers, in sentences.
  std::vector<std::string> left_out = {};
  /// Units that names may mean and that are not applied, in sentences.
  std::vector<std::string> possible_units = {};
  std::string sampling_fault = {};  ///< why there is no rate, though there is a time: a sentence
  std::vector<MeasuredChannel> channels = {};

  [[nodiscard]] long rows() const;
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

/// How a table was read, a sentence each: layout, times, units, what was left out.
[[nodiscard]] std::vector<std::string> reading_in_words(const MeasuredTable& table);

/// What is odd about a channel of a table, each the rest of a sentence that begins with its name.
[[nodiscard]] std::vector<std::string> oddities(const MeasuredTable& table,
                                                const MeasuredChannel& channel);

}  // namespace wheeltap::apps
