// The case of a model update: a structure with unknown parameters and its measured modes.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "identification/findings/remarks.hpp"
#include "identification/structural/modal_data.hpp"
#include "identification/structural/observed_states.hpp"
#include "identification/structural/structure_model.hpp"

namespace wheeltap::identification {

/// The simulation that a case defines.
struct ModalSimulation {
  std::vector<double> parameters;  ///< parameter values, in the order of the structure's parameters
  int modes = 0;
  double cov = 0.0;       ///< sd of a frequency = cov · true frequency
  double shape_sd = 0.0;  ///< sd of shape entries, with a largest entry of 1; 0: no shapes
  std::uint64_t seed = 1;
};

struct UpdateCase {
  std::string title = {};
  std::shared_ptr<const StructureModel> structure = {};
  ModalData data = {};
  std::optional<ModalSimulation> simulation = {};
  /// Set if several states were measured; `data` then contains their frequencies, concatenated.
  std::shared_ptr<const ObservedStates> states = {};
};

/// The lowest elastic modes of the structure with these parameters, by the full solution:
/// frequencies [Hz], and shapes at the sensors (sensors × modes, largest entry 1). `true_modes`
/// throws fem::InvalidStructure, std::invalid_argument.
struct TrueModes {
  std::vector<double> frequencies_hz;
  Eigen::MatrixXd shapes;
};
[[nodiscard]] TrueModes true_modes(const UpdateCase& update_case,
                                   std::span<const double> parameters, int modes);

/// Simulates the data: Gaussian noise on frequencies and shape entries, with the standard
/// deviations of the truth unless the data specify them. Throws the exceptions of `true_modes`.
void simulate(UpdateCase& update_case, std::uint64_t seed);

/// Plausibility of the structure and its sensors (structure_plausibility.hpp).
[[nodiscard]] std::vector<Remark> implausible(const UpdateCase& update_case);

}  // namespace wheeltap::identification
