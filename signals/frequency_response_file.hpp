// Reading of frequency response functions from universal files (dataset 58, function type 4).
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
  /// The quantity of each output: 0 displacement, 1 velocity, 2 acceleration. Empty if the file
  /// does not state the quantities.
  std::vector<int> orders = {};
  bool transposed = false;  ///< true: outputs and inputs were exchanged by reciprocity (roving
                            ///< hammer)
};

/// Reads all frequency response functions of a file and converts outputs with known units to SI. If
/// the number of reference degrees of freedom exceeds that of response degrees of freedom, outputs
/// and inputs are exchanged (reciprocity). Throws io::FileError if the file is not a universal file
/// or has no frequency response function. Also throws io::FileError if the functions have different
/// frequencies, or if one occurs twice or is missing.
[[nodiscard]] MeasuredResponses read_frequency_responses(const std::filesystem::path& path);

}  // namespace wheeltap::signals
