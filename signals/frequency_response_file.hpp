// Frequency responses as universal files hold them (dataset 58, function type 4).
#pragma once

#include <filesystem>
#include <vector>

#include "io/universal/universal_file.hpp"
#include "signals/frequency_responses.hpp"
#include "signals/units.hpp"

namespace wheeltap::signals {

struct MeasuredResponses {
  FrequencyResponses responses = {};
  std::vector<io::UniversalDof> outputs = {}, inputs = {};
  std::vector<Conversion> conversions = {};  ///< of the outputs; empty where they were exchanged
  /// Of the outputs: 0 displacement, 1 velocity, 2 acceleration; empty where the file says none.
  std::vector<int> orders = {};
  bool transposed = false;  ///< outputs and inputs were exchanged, by reciprocity: a roving hammer
};

/// All frequency responses of the file; those of outputs whose units are known in SI. Where there
/// are more references than responses the two are exchanged. Throws io::FileError for what is no
/// such file, and for responses that do not share their lines, do not make a whole matrix, or come
/// twice.
[[nodiscard]] MeasuredResponses read_frequency_responses(const std::filesystem::path& path);

}  // namespace wheeltap::signals
