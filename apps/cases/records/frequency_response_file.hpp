// Frequency responses as universal files hold them (dataset 58, function type 4).
#pragma once

#include <filesystem>
#include <vector>

#include "apps/cases/records/modes_file.hpp"
#include "apps/cases/records/record_reading.hpp"
#include "signals/frequency_responses.hpp"

namespace wheeltap::apps {

struct MeasuredResponses {
  signals::FrequencyResponses responses = {};
  std::vector<MeasuredSensor> sensors = {};  ///< an output each
  std::vector<std::string> inputs = {};      ///< "2:+Z"
  std::vector<ChannelUse> channels = {};     ///< of the outputs: units, where the file says them
  /// Of the outputs: 0 displacement, 1 velocity, 2 acceleration; empty where the file says none.
  std::vector<int> orders = {};
  bool transposed = false;  ///< outputs and inputs were exchanged, by reciprocity: a roving hammer
};

/// All frequency responses of the file; those of outputs whose units are known in SI. Where there
/// are more references than responses the two are exchanged. Throws io::FileError for what is no
/// such file, and for responses that do not share their lines, do not make a whole matrix, or come
/// twice.
[[nodiscard]] MeasuredResponses read_frequency_responses(const std::filesystem::path& path);

}  // namespace wheeltap::apps
