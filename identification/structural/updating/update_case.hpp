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

/// True values and noise with which a case simulates its data.
struct ModalSimulation {
  std::vector<double> parameters;  ///< true values, in the order of the structure's parameters
  int modes = 0;
  double cov = 0.0;       ///< sd of a frequency divided by its true value
  double shape_sd = 0.0;  ///< sd of shape entries, if the largest entry is 1; 0: no shapes
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

/// Simulates the data, with Gaussian noise on frequencies and shape entries. The sds are those of
/// the data or, if the data specify none, of the simulation. Throws the exceptions of `true_modes`.
void simulate(UpdateCase& update_case, std::uint64_t seed);

/// Checks the plausibility of the structure and its sensors (structure_plausibility.hpp).
[[nodiscard]] std::vector<Remark> implausible(const UpdateCase& update_case);

}  // namespace wheeltap::identification
