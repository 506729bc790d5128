// Frequency responses as universal files hold them (dataset 58, function type 4).
#pragma once

#include <filesystem>
#include <vector>

#include "apps/modes_file.hpp"
#include "signals/frequency_responses.hpp"

namespace wheeltap::apps {

struct MeasuredResponses {
  signals::FrequencyResponses responses = {};
  std::vector<MeasuredSensor> sensors = {};  ///< an output each
  std::vector<std::string> inputs = {};      ///< "2:+Z"
  bool transposed = false;  ///< outputs and inputs were exchanged, by reciprocity: a roving hammer
};

/// All frequency responses of the file, in its own units. Where there are more references than
/// responses the two are exchanged. Throws io::FileError for what is no such file,
/// and for responses that do not share their lines, do not make a whole matrix, or come twice.
[[nodiscard]] MeasuredResponses read_frequency_responses(const std::filesystem::path& path);

}  // namespace wheeltap::apps
