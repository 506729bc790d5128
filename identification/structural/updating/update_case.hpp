// What is asked of a structure whose parameters are to be learnt from its modes.
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

/// Modes that the case has simulated.
struct ModalSimulation {
  std::vector<double> parameters;  ///< in the order of the structure's
  int modes = 0;
  double cov = 0.0;       ///< sd of a frequency = cov · true frequency
  double shape_sd = 0.0;  ///< of entries, shapes scaled to a largest entry of 1; 0: no shapes
  std::uint64_t seed = 1;
};

struct UpdateCase {
  std::string title = {};
  std::shared_ptr<const StructureModel> structure = {};
  ModalData data = {};
  std::optional<ModalSimulation> simulation = {};
  /// Where several states were measured; `data` are then their frequencies in a row.
  std::shared_ptr<const ObservedStates> states = {};
};

/// The lowest elastic modes of the structure with these parameters, by the full solve: frequencies
/// [Hz], and shapes at the sensors (sensors × modes, largest entry 1). Throws
/// fem::InvalidStructure, std::invalid_argument.
struct TrueModes {
  std::vector<double> frequencies_hz;
  Eigen::MatrixXd shapes;
};
[[nodiscard]] TrueModes true_modes(const UpdateCase& update_case,
                                   std::span<const double> parameters, int modes);

/// Fills in the data from the truth: Gaussian noise on the frequencies and on the shapes' entries,
/// scatters as the truth has them unless the data say their own. Throws as `true_modes`.
void simulate(UpdateCase& update_case, std::uint64_t seed);

/// What the structure and its sensors can hardly be meant to be (structure_plausibility.hpp).
[[nodiscard]] std::vector<Remark> implausible(const UpdateCase& update_case);

}  // namespace wheeltap::identification
