// Frequency responses from universal files (dataset 58, function type 4).
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
  std::vector<Conversion> conversions = {};  ///< one per output; empty if `transposed`
  /// One per output: 0 displacement, 1 velocity, 2 acceleration; empty if the file does not state
  /// it.
  std::vector<int> orders = {};
  bool transposed = false;  ///< a roving hammer: outputs and inputs exchanged by reciprocity
};

/// Reads all frequency responses of a file and converts outputs with known units to SI. If there
/// are more references than responses, outputs and inputs are exchanged (reciprocity). Throws
/// io::FileError for another kind of file, and if responses have different frequencies, are
/// duplicates or leave a gap in the matrix.
[[nodiscard]] MeasuredResponses read_frequency_responses(const std::filesystem::path& path);

}  // namespace wheeltap::signals
